"""Contradictions within and between the joint sets of a rock mass."""

from collections.abc import Iterator

from jointwave.cases.checks.scene import Wrong, of_damping, of_fracture, of_strength, within
from jointwave.cases.geometry.sets import in_order
from jointwave.cases.partition.joints import plane_sets
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.rock_mass import RockMass

NEEDS = (("offset", "spacing"), ("scatter", "spacing"), ("offset", "ends_at"), ("seed", "scatter"))


def of_sets(scene: RockMass) -> Iterator[Wrong]:
    """Yield contradictions of the joint sets."""
    sets, file = scene.joint_sets, scene.domain.file_key
    for i, one in enumerate(sets):
        names = _of_names(one, [other.name for other in sets], i)
        places = _of_places_in_file(one, file) if file else _of_places(one)
        for rule in (names, places, _of_law(one, scene)):
            yield from within(f"joint_sets[{i}]", rule)
    try:
        in_order(plane_sets([one.model_copy(update={"regions": []}) for one in sets]))
    except ValueError as error:
        yield "joint_sets", None, str(error)


def _of_names(one: JointSet, names: list[str], index: int) -> Iterator[Wrong]:
    if one.name in names[:index]:
        yield "name", one.name, "must be unique"
    for name in one.ends_at:
        if name == one.name or name not in names:
            known = ", ".join(other for other in names if other != one.name)
            yield "ends_at", name, f"must name other sets: {known or 'none'}"
    if len(set(one.ends_at)) < len(one.ends_at):
        yield "ends_at", one.ends_at, "must not repeat a set"


def _of_places_in_file(one: JointSet, file: str) -> Iterator[Wrong]:
    for key in ("through", "ends_at", "regions", "offset", "scatter", "seed"):
        if value := getattr(one, key):
            yield key, value, f"has no effect: {file} has the joints"


def _of_places(one: JointSet) -> Iterator[Wrong]:
    if one.spacing is None and one.through is None:
        allowed = "give a spacing, or through = [x, y], in space [x, y, z], for one joint"
        yield "spacing", None, allowed
    for key, other in NEEDS:
        if one.gives(key) and not getattr(one, other):
            yield key, getattr(one, key), f"has no meaning without {{table}}.{other}"
    if one.scatter and one.seed is None:
        yield "seed", None, "is required with {table}.scatter"


def _of_law(one: JointSet, scene: RockMass) -> Iterator[Wrong]:
    for key in ("normal_stiffness", "shear_stiffness"):
        if getattr(one, key) is None:
            yield key, None, "is required"
    yield from of_strength(one)
    yield from of_damping(one, scene)
    assert one.normal_stiffness is not None
    yield from of_fracture(one, one.normal_stiffness, "K_n")
