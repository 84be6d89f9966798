"""Failures that an experiment notes and outlives."""

from cases.errors import SceneError, UnstableError

FAILURES = (SceneError, UnstableError)  # of a scene that cannot be so, or a run that cannot go on


def reason_of(error: Exception) -> str:
    """Return why something could not be run, without where."""
    return getattr(error, "allowed", str(error))
