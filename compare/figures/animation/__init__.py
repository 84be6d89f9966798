"""Films and views of the bodies of a scene."""
