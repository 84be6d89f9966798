"""The checks of a scene as a whole, where it is read, changed or handed to a solver."""

from pydantic_core import PydanticCustomError

from jointwave.cases.checks import pillar
from jointwave.cases.errors import SceneError, all_of
from jointwave.cases.scene_type import AnyScene, Either
from jointwave.cases.schema.scene import Scene


def checked(scene: Either) -> Either:
    """Return a scene; raises SceneError, a line a contradiction, where its tables do not fit
    together."""
    if found := _contradictions(scene):
        raise all_of(_error(scene, one) for one in found)
    return scene


def _contradictions(scene: AnyScene) -> list[PydanticCustomError]:
    if isinstance(scene, Scene):
        return pillar.contradictions(scene)
    from jointwave.cases.checks import rock_mass  # with shapely, which no pillar needs

    return rock_mass.contradictions(scene)


def _error(scene: AnyScene, found: PydanticCustomError) -> SceneError:
    about = found.context or {}
    return SceneError(scene.where, about["key"], about["found"], about["allowed"])
