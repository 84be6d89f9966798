"""Scenes that can be read but that no engine solves yet: the one place that refuses them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cases.errors import SceneError
from cases.schema.scene import Scene

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass


def solved(scene: Scene | RockMass) -> Scene:
    """Return a scene of a kind that can be simulated; raises SceneError for a rock mass."""
    if isinstance(scene, Scene):
        return scene
    allowed = (
        "is a rock mass, which no engine solves yet: it is checked and cut into blocks, and "
        "jointwave explain shows them"
    )
    raise SceneError(scene.where, "domain", None, allowed)
