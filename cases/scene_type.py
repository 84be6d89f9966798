"""The two kinds of scenes, a pillar (`Scene`) and a rock mass (`RockMass`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, TypeVar

from jointwave.cases.errors import SceneError

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass
    from jointwave.cases.schema.scene import Scene

AnyScene: TypeAlias = "Scene | RockMass"  # a text: to import it costs nothing
Either = TypeVar("Either", bound="AnyScene")


def pillar_of(scene: AnyScene, what: str = "this") -> Scene:
    """Return a scene that is a pillar; raises SceneError of a rock mass.

    what : accepts pillars only, in words.
    """

    if scene.is_column:
        return scene
    raise SceneError(scene.where, "domain", None, f"is a rock mass; {what} accepts pillars only")
