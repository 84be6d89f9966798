"""The checks of a scene as a whole, where it is read, changed or handed to a solver."""

from itertools import islice

from pydantic_core import PydanticCustomError

from jointwave.cases.checks import pillar
from jointwave.cases.checks.shared import Rules, Wrong
from jointwave.cases.errors import SceneError, all_of
from jointwave.cases.scene_type import AnyScene, Either
from jointwave.cases.schema.scene import Scene


def checked(scene: Either) -> Either:
    """Return a scene; raises SceneError, a line a contradiction, where its tables do not fit
    together."""
    if found := _first_of(_rules(scene)):
        raise all_of(SceneError(scene.where, *one) for one in found)
    return scene


def _rules(scene: AnyScene) -> Rules:
    if isinstance(scene, Scene):
        return pillar.rules(scene)
    from jointwave.cases.checks import rock_mass  # with shapely, which no pillar needs

    return rock_mass.rules(scene)


def _first_of(rules: Rules) -> list[Wrong]:
    """Return the first contradiction that each rule finds; what stops a rule after one is taken for
    its consequence."""
    found: list[Wrong] = []
    for rule in rules:
        try:
            found.extend(islice(rule, 1))
        except PydanticCustomError as error:
            about = error.context or {}
            found.append((about["key"], about["found"], about["allowed"]))
        except Exception:
            if not found:
                raise
    return found
