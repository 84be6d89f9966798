"""Conditions under which an exact solution covers a rock mass."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import across, in_components
from jointwave.cases.partition.joints import strata
from jointwave.cases.partition.shape import SIDES, shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.pulse import Wave
from jointwave.cases.schema.rock_mass import Region, RockMass
from jointwave.compare.solvers.record import Answer

PARALLEL = 1e-6  #: sine of the largest angle between directions that count as parallel
#: Sine of 1 degree, the angle to joints, layers or a free face below which a wave counts as running
#: along them: its reflection cancels it there.
ALONG = 0.0175


class Face(NamedTuple):
    """A free face: outward unit normal [d], and distance from the origin along it, m."""

    normal: np.ndarray
    offset: float


def holds(scene: RockMass, held: tuple[str, ...], *against: tuple[bool, str]) -> Answer:
    """Return whether a solution for linear joints in undamped rock applies to a scene, or the first
    reason why not.

    held : physics that it covers, by the names below. against : other reasons against it.
    """
    gravity = scene.gravity is not None and bool(scene.gravity.acceleration)
    damped = any(one.is_damped for one in scene.joint_sets)
    physics = {
        "no waves": (not scene.waves, "no wave enters"),
        "waves": (bool(scene.waves), "a wave enters"),
        "loads": (bool(scene.loads), "a load acts"),
        "gravity": (gravity, "gravity acts"),
        "openings": (bool(scene.domain.holes), "the domain has openings"),
        "prestress": (scene.prestress is not None, "the rock is prestressed"),
        "regions": (bool(scene.regions), "regions differ in rock"),
        "damped joints": (damped, "the joints are damped"),
    }
    beyond = (one for name, one in physics.items() if name not in held)
    return Answer.unless(*beyond, *against) and linear_rock(scene)


def linear_rock(scene: RockMass) -> Answer:
    """Return whether a scene is undamped rock with linear joints, or why not."""
    damping, meshed = scene.damping, scene.domain.given is not None and bool(scene.joint_sets)
    return Answer.unless(
        (bool(damping.alpha), "the damping is proportional to mass"),
        (bool(damping.rayleigh and damping.rayleigh.coefficients[1]), "the rock is damped"),
        (scene.rock.quality_factor is not None, "the rock has a quality_factor"),
        (bool(damping.local), "the damping is local and not linear"),
        (meshed, "the joints are those of a mesh"),
        *((not law, law.reason) for law in map(linear_law, scene.joint_sets)),
    )


def linear_law(one: JointSet) -> Answer:
    """Return whether the law of a joint set is linear, or why not."""
    slips = one.friction_angle is not None or one.cohesion is not None
    return Answer.unless(
        (one.tension is False, f"joint set {one.name!r} carries no tension"),
        *((part.of(one), f"joint set {one.name!r}: {part.words}") for part in PARTS),
        (slips, f"joint set {one.name!r} can slip"),
    )


def waves_leave(scene: RockMass, face: Face | None = None) -> Answer:
    """Return whether waves leave through all sides except a free face: each other side must be
    quiet; or periodic, with waves and joints invariant along the shift; or a roller side, if they
    also do not move rock normal to it."""
    for side, normals in shape_of(scene.domain).normals().items():
        held = getattr(scene.boundaries, side)
        if held == "periodic" and not _is_invariant(scene, side):
            return Answer(f"the {side} is periodic, and waves or joints vary along it")
        if held == "roller" and not (
            _is_invariant(scene, side) and all(not _moves(one, normals[0]) for one in scene.waves)
        ):
            return Answer(f"the {side} is on rollers, and waves vary along it or move rock into it")
        is_face = held == "free" and face is not None and (normals @ face.normal).min() > ALONG
        if held in ("free", "fixed") and not is_face:
            return Answer(f"the {side} is {held} and reflects waves")
    return Answer()


def free_face(scene: RockMass) -> Face | None:
    """Return the one plane free face that waves of a scene reach; None without, or with several."""
    outline, found = shape_of(scene.domain), []
    for side in outline.normals():
        if getattr(scene.boundaries, side) == "free":
            for corners, n in outline.faces_of(side):
                if any(n @ np.array(wave.direction) > ALONG for wave in scene.waves):
                    found.append(Face(n, float(corners.mean(axis=0) @ n)))
    near = PARALLEL * outline.size
    one_plane = all(
        along(a.normal, b.normal) and abs(a.offset - b.offset) <= near for a, b in pairwise(found)
    )
    return found[0] if found and one_plane else None


def prestress_of(scene: RockMass) -> np.ndarray:
    """Return the components of a scene's initial stress, Pa, compression positive."""
    dim = scene.domain.dimension
    tensor = np.zeros((dim, dim)) if scene.prestress is None else scene.prestress.tensor
    return in_components(tensor)


def all_parallel(scene: RockMass) -> bool:
    """Return whether all joints and region boundaries of a scene are parallel."""
    return all(along(*pair) for pair in pairwise(normals_of(scene)))


def normals_of(scene: RockMass) -> list[np.ndarray]:
    """Return unit normals [d] of the joint sets and region boundaries."""
    planes: list[JointSet | Region] = [*scene.joint_sets, *strata(scene.regions)]
    return [one.normal for one in planes]


def along(one: np.ndarray, other: np.ndarray, sine: float = PARALLEL) -> bool:
    """Return whether two unit vectors are parallel, in the same or opposite sense."""
    return bool(np.linalg.norm(one - (one @ other) * other) < sine)


def _is_invariant(scene: RockMass, side: str) -> bool:
    """Return whether joints and waves do not vary along the axis normal to a side."""
    dim = scene.domain.dimension
    axis = np.eye(dim)[SIDES[dim].index(side) // 2]
    every = [*normals_of(scene), *(np.array(one.direction) for one in scene.waves)]
    return all(abs(one @ axis) < PARALLEL for one in every)


def _moves(wave: Wave, normal: np.ndarray) -> bool:
    """Return whether a wave moves rock along a normal."""
    n = np.array(wave.direction)
    return bool(abs((n if wave.kind == "P" else across(n, wave)) @ normal) > PARALLEL)
