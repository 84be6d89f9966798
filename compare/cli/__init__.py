"""The command line, and scene files as tests."""


class SceneWarning(UserWarning):
    """A probable mistake in a scene that is a test."""
