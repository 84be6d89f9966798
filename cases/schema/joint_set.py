"""Keys of a joint set of a rock mass, and contradictions within and between sets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from jointwave.cases.schema.joint import Joints
from jointwave.cases.schema.shared_checks import SNAP, check_strength, rounded_up
from jointwave.cases.schema.values import Point, Positive, Words, contradiction

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass


class JointSet(Joints):
    """A set of parallel joints, or one joint, and its law."""

    name: Words  #: used in `ends_at`, tables and figures
    #: degrees from the horizontal, counter-clockwise; the joints run along (cos, sin) of it
    dip: Annotated[float, Field(ge=-180, le=180)]
    spacing: Positive | None = None  #: m, across the joints; absent: one joint, `through` a point
    through: Point | None = None  #: m, a point of one of the joints; absent: the origin
    ends_at: list[str] = Field(default_factory=list)  #: names of sets at whose joints these end
    #: names of [[regions]] that it cuts, "rock" for rock in no region; absent: all
    regions: list[str] = Field(default_factory=list)
    #: offset along the `ends_at` joints from row to row, over the spacing; 0.5: brickwork
    offset: Annotated[float, Field(ge=0, lt=1)] = 0.0
    #: coefficient of variation of the spacing; uniformly distributed
    scatter: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None  #: of the scatter


def check_sets(scene: RockMass) -> None:
    """Raise the first contradiction of the joint sets."""
    from jointwave.cases.geometry.sets import in_order
    from jointwave.cases.partition.joints import plane_sets

    sets = scene.joint_sets
    for i, one in enumerate(sets):
        table = f"joint_sets[{i}]"
        _check_names(table, one, i, sets)
        (_check_places if scene.domain.mesh is None else _check_in_mesh)(table, one)
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


def _check_in_mesh(table: str, one: JointSet) -> None:
    for key in ("through", "ends_at", "regions", "offset", "scatter", "seed"):
        if value := getattr(one, key):
            allowed = "has no effect: domain.mesh has the joints"
            raise contradiction(f"{table}.{key}", value, allowed)


def _check_places(table: str, one: JointSet) -> None:
    if one.spacing is None and one.through is None:
        allowed = "give a spacing, or through = [x, y] for one joint"
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
    check_strength(table, one)
    if one.damping_ratio is not None and scene.damping.rayleigh is not None:
        allowed = "damping.rayleigh already sets the dashpots: give one of them"
        raise contradiction(f"{table}.damping_ratio", one.damping_ratio, allowed)
    strength, energy = one.tensile_strength, one.fracture_energy
    if strength is None or energy is None:
        return
    least = SNAP * strength**2 / (2 * (one.normal_stiffness or 0.0))
    if energy < least:
        raise contradiction(
            f"{table}.fracture_energy",
            energy,
            "must exceed tensile_strength^2 / (2 K_n), or the joint snaps back: "
            f"at least {rounded_up(least):.4g} J/m2",
        )
