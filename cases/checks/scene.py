"""The checks of a scene as a whole, where it is read, changed or handed to a solver."""

from collections.abc import Iterator
from itertools import islice

from pydantic_core import PydanticCustomError

from jointwave.cases.checks import pillar
from jointwave.cases.checks.rules import Wrong, of_quality, of_time
from jointwave.cases.errors import SceneError, all_of
from jointwave.cases.scene_type import AnyScene, Either


def checked(scene: Either) -> Either:
    """Return a scene; raises SceneError, a line a contradiction, where its tables do not fit
    together."""
    if found := _first_of([*_own_rules(scene), of_time(scene), of_quality(scene)]):
        raise all_of(SceneError(scene.where, *one) for one in found)
    return scene


def _own_rules(scene: AnyScene) -> list[Iterator[Wrong]]:
    """Return the rules of tables that a column alone has, or a body in two or three dimensions."""
    if scene.is_column:
        return pillar.rules(scene)
    from jointwave.cases.checks import rock_mass  # with shapely, which no pillar needs

    return rock_mass.rules(scene)


def _first_of(rules: list[Iterator[Wrong]]) -> list[Wrong]:
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
