"""The two kinds of scenes, a pillar (`Scene`) and a rock mass (`RockMass`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, TypeVar

from jointwave.cases.errors import SceneError

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass
    from jointwave.cases.schema.scene import Scene

AnyScene: TypeAlias = "Scene | RockMass"  # a string, so that nothing is imported
Either = TypeVar("Either", bound="AnyScene")


def pillar_of(scene: AnyScene, what: str = "this") -> Scene:
    """Return a scene that is a pillar. Raises SceneError for a rock mass.

    what : the feature that accepts pillars only, for the message.
    """

    if scene.is_column:
        return scene
    raise SceneError(scene.where, "domain", None, f"is a rock mass; {what} accepts pillars only")
