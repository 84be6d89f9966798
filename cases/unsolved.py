"""Scenes that can be read but that no engine solves yet: the one place that refuses them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cases.errors import SceneError
from cases.files import read_toml
from cases.schema.scene import Scene

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

ALLOWED = (
    "is a rock mass, which no engine solves yet: it is checked and cut into blocks, and "
    "jointwave explain shows them"
)


def solved(scene: Scene | RockMass) -> Scene:
    """Return a scene of a kind that can be simulated; raises SceneError for a rock mass."""
    if isinstance(scene, Scene):
        return scene
    raise SceneError(scene.where, "domain", None, ALLOWED)


def refuse_unsolved(path: Path, largest: int) -> None:
    """Raise SceneError where a file (of at most `largest` bytes) holds a rock mass; whatever else
    is wrong with it is for its reader to say."""
    try:
        table = read_toml(path, largest)
    except ValueError:
        return
    if "domain" in table:
        raise SceneError(str(path), "domain", None, ALLOWED)
