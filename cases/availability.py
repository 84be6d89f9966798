"""What the vocabulary can say and no engine can simulate yet: refused, never ignored."""

from collections.abc import Iterator

from cases.errors import SceneError
from cases.scene import Scene


def refuse_unavailable(scene: Scene, where: str) -> None:
    """Raise SceneError for the first key whose physics is not built."""
    for key, value in _unavailable(scene):
        raise SceneError(where, key, value, "not available yet")


def _unavailable(scene: Scene) -> Iterator[tuple[str, object]]:
    if scene.numerics.continuum.scheme == "implicit":
        yield "numerics.continuum.scheme", "implicit"
