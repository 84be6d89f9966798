"""Contradictions within and between the joint sets of a rock mass."""

from jointwave.cases.checks.shared import check_damping, check_fracture, check_strength
from jointwave.cases.geometry.sets import in_order
from jointwave.cases.partition.joints import plane_sets
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.values import contradiction


def check_sets(scene: RockMass) -> None:
    """Raise the first contradiction of the joint sets."""
    sets = scene.joint_sets
    for i, one in enumerate(sets):
        table = f"joint_sets[{i}]"
        _check_names(table, one, i, sets)
        if key := scene.domain.file_key:
            _check_in_file(table, one, key)
        else:
            _check_places(table, one)
        _check_law(table, one, scene)
    try:
        in_order(plane_sets([one.model_copy(update={"regions": []}) for one in sets]))
    except ValueError as error:
        raise contradiction("joint_sets", None, str(error)) from None


def _check_names(table: str, one: JointSet, index: int, sets: list[JointSet]) -> None:
    names = [other.name for other in sets]
    if one.name in names[:index]:
        raise contradiction(f"{table}.name", one.name, "must be unique")
    for name in one.ends_at:
        if name == one.name or name not in names:
            known = ", ".join(other for other in names if other != one.name)
            raise contradiction(
                f"{table}.ends_at", name, f"must name other sets: {known or 'none'}"
            )
    if len(set(one.ends_at)) < len(one.ends_at):
        raise contradiction(f"{table}.ends_at", one.ends_at, "must not repeat a set")


def _check_in_file(table: str, one: JointSet, file: str) -> None:
    for key in ("through", "ends_at", "regions", "offset", "scatter", "seed"):
        if value := getattr(one, key):
            allowed = f"has no effect: {file} has the joints"
            raise contradiction(f"{table}.{key}", value, allowed)


def _check_places(table: str, one: JointSet) -> None:
    if one.spacing is None and one.through is None:
        allowed = "give a spacing, or through = [x, y], in space [x, y, z], for one joint"
        raise contradiction(f"{table}.spacing", None, allowed)
    single = one.spacing is None
    for key, value in (("offset", one.offset), ("scatter", one.scatter)):
        if value and single:
            raise contradiction(f"{table}.{key}", value, f"has no meaning without {table}.spacing")
    if one.offset and not one.ends_at:
        allowed = f"has no meaning without {table}.ends_at"
        raise contradiction(f"{table}.offset", one.offset, allowed)
    if one.scatter and one.seed is None:
        raise contradiction(f"{table}.seed", None, f"is required with {table}.scatter")
    if one.seed is not None and not one.scatter:
        raise contradiction(f"{table}.seed", one.seed, f"has no meaning without {table}.scatter")


def _check_law(table: str, one: JointSet, scene: RockMass) -> None:
    for key in ("normal_stiffness", "shear_stiffness"):
        if getattr(one, key) is None:
            raise contradiction(f"{table}.{key}", None, "is required")
    assert one.normal_stiffness is not None
    check_strength(table, one)
    check_damping(table, one, scene)
    check_fracture(table, one, one.normal_stiffness, "K_n")
