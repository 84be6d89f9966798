"""The two kinds of scenes, a pillar (`Scene`) and a rock mass (`RockMass`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, TypeVar

from pydantic_core import PydanticCustomError

from jointwave.cases.errors import SceneError

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass
    from jointwave.cases.schema.scene import Scene

AnyScene: TypeAlias = "Scene | RockMass"  # a text: to import it costs nothing
Either = TypeVar("Either", bound="AnyScene")


def checked(scene: Either) -> Either:
    """Return a scene whose tables were changed in memory; raises SceneError where they do not fit
    together any more."""
    from jointwave.cases.schema import consistency
    from jointwave.cases.schema.scene import Scene

    try:
        if isinstance(scene, Scene):
            consistency.check(scene)
        else:
            from jointwave.cases.schema import (
                rock_mass_checks,  # with shapely, which no pillar needs
            )

            rock_mass_checks.check(scene)
    except PydanticCustomError as error:
        about = error.context or {}
        key, found, allowed = about.get("key", ""), about.get("found"), error.message()
        raise SceneError(scene.where, key, found, allowed) from None
    return scene


def pillar_of(scene: AnyScene, what: str = "this") -> Scene:
    """Return a scene that is a pillar; raises SceneError of a rock mass.

    what : accepts pillars only, in words.
    """
    from jointwave.cases.schema.scene import Scene

    if isinstance(scene, Scene):
        return scene
    raise SceneError(scene.where, "domain", None, f"is a rock mass; {what} accepts pillars only")
