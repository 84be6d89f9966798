"""The two kinds of scenes, a pillar (`Scene`) and a rock mass (`RockMass`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cases.errors import SceneError
from cases.schema.scene import Scene

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

    AnyScene = Scene | RockMass


def pillar_of(scene: AnyScene, what: str = "this") -> Scene:
    """Return a scene that is a pillar; raises SceneError of a rock mass.

    what : takes pillars alone, in words.
    """
    if isinstance(scene, Scene):
        return scene
    raise SceneError(scene.where, "domain", None, f"is a rock mass; {what} takes pillars alone")
