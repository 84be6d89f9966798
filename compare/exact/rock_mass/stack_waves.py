"""Scenes of plane P and S waves at one or several parallel joints, at any angle, as records of
receivers (`plane.oblique_joint`, `plane.parallel_joints`).

Displacement is the same solution for the pulse's time integral; opening and slip of a joint are the
jumps of displacement across it, and a point on a joint reads the mean of both sides. With
evanescent P waves the motion begins before its cause: its value at t = 0 is not in the scene, which
begins at rest, and is added to the error bound. In space an S wave is the sum of its parts in and
across its plane of incidence, SV and SH.

Valid for parallel linear joints, with dashpots or without, in undamped rock with sides through
which waves leave, and any number of plane waves that meet them after the start (`stack`).
"""

from collections.abc import Callable
from functools import partial

import numpy as np
import xarray as xr

from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.locate import contact_at, sides_at
from jointwave.cases.geometry.measure import frames
from jointwave.cases.incident import COMPONENT, plane_wave
from jointwave.cases.partition.shape import TOLERANCE
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.plane.layer_pulses import Fields, fields
from jointwave.compare.exact.plane.waves import PlaneMotion
from jointwave.compare.exact.rock_mass import conditions
from jointwave.compare.exact.rock_mass.conditions import PARALLEL, normals_of, prestress_of
from jointwave.compare.exact.rock_mass.stack import JointStack, begins_before, scatters, stack_of
from jointwave.compare.solvers.record import Answer, Kind, Line, Rock, Solver, thin
from jointwave.results.dataset import dataset

#: Causes of the engines' misfits against these waves.
DISTANCES = {
    Kind.NUMERICAL: {"continuum-jointed": "elements and time stepping of the jointed rock"},
    Kind.MODELLING: {
        "dem": "rigid instead of deformable blocks",
        "continuum-equivalent": "joints smeared over the rock",
    },
}
OFFSET = 1e-13  #: distance from a joint that counts as off it, over the domain's size


#: Function of (scene, stack, places [m, d] (m), times (s)).
Motion = Callable[["RockMass", JointStack, np.ndarray, np.ndarray], PlaneMotion]


def holds(scene: RockMass, one: bool) -> Answer:
    """Return whether a scene has plane waves at one joint or, unless `one`, at several planes."""
    held = ("waves", "prestress", "regions", "damped joints")
    answer = conditions.holds(scene, held) and scatters(scene)
    if not answer:
        return answer
    stack = stack_of(scene)
    count, layered = len(stack.joints) - stack.has_face, bool(scene.regions)
    alone = count == 1 and not layered and not stack.has_face
    return Answer.unless(
        (one and layered, "regions differ in rock: see parallel-joints"),
        (one and stack.has_face, "a side is free: see parallel-joints"),
        (one and count != 1, f"there are {count} joints: see parallel-joints"),
        (not one and alone, "there is one joint"),
    ) and begins_before(scene, stack)


def solve(scene: RockMass, name: str, motion: Motion | None = None) -> xr.Dataset:
    """Return the records of a scene's receivers; motion : replaces `motion_at`."""
    stack, times, frame = stack_of(scene), sample_times(scene), frame_of(scene)
    joints = joint_receivers(scene, stack)
    points, on_joint, beyond = point_receivers(scene, stack)
    beside = _joint_offset(stack) * frame[0]
    places = [points, beyond, joints - beside, joints + beside]
    found = (motion or motion_at)(scene, stack, np.concatenate(places), times)
    ends = np.cumsum([len(part) for part in places])[:-1]
    at_points, behind, here, there = map(
        PlaneMotion._make, zip(*(np.split(x, ends) for x in found), strict=True)
    )
    for one, other in zip(at_points, behind, strict=True):
        one[on_joint] = (one[on_joint] + other) / 2
    pressed, size = prestress_of(scene)[:, None], np.abs(frame)
    jump = frame @ (there.displacement - here.displacement)
    traction = frame @ on_face(pressed - here.stress, frame[0])
    slipped = (here.displacement_error + there.displacement_error) @ size.T
    pulled = on_face(here.stress_error[..., None], size[0])[..., 0] @ size.T
    values = {
        "velocity": at_points.velocity.swapaxes(1, 2),
        "displacement": at_points.displacement.swapaxes(1, 2),
        "stress": (pressed - at_points.stress).swapaxes(1, 2),
        "traction": traction.swapaxes(1, 2),
        "gap": jump[:, 0],
        "slip": jump[:, 1:].swapaxes(1, 2),
    }
    names = "velocity", "displacement", "stress"
    errors = {name: getattr(at_points, f"{name}_error") for name in names}
    errors |= {"traction": pulled, "gap": slipped[:, 0], "slip": slipped[:, 1:]}
    if not scene.in_space:  # one slip
        values["slip"], errors["slip"] = values["slip"][..., 0], errors["slip"][:, 0]
    return dataset(scene, name, times, values, errors=errors)


def motion_at(
    scene: RockMass, stack: JointStack, places: np.ndarray, times: np.ndarray
) -> PlaneMotion:
    """Return the motion of all waves at places [m, d] (m), relative to the start of the scene."""
    m, d, n = *places.shape, len(times)
    c = d * (d + 1) // 2
    total = [np.zeros(shape) for shape in ((m, d, n), (m, d, n), (m, c, n), (m, d), (m, d), (m, c))]
    for one in scene.waves if m else ():
        wave = plane_wave(scene, one)
        begin = wave.pulse.impulse(-wave.lateness(places))[:, None] * wave.polarisation
        free, parts = wave.motion(places, times[:1]), []
        for signal in (wave.pulse.value, wave.pulse.impulse):
            each = [fields(signal, met, places - wave.through, times) for met in stack.met_by(wave)]
            parts.append(Fields(*(np.sum(x, axis=0) for x in zip(*each, strict=True))))
        (velocity, stress, v_error, s_error), by_integral = parts
        moved = by_integral.velocity - begin[..., None]
        early = np.abs(moved[..., 0])
        v_early, s_early = (
            np.abs(x[..., 0] - y[..., 0])
            for x, y in ((velocity, free.velocity), (stress, free.stress))
        )
        errors = by_integral.velocity_error + early, v_error + v_early, s_error + s_early
        for sum_, part in zip(total, (moved, velocity, stress, *errors), strict=True):
            sum_ += part
    return PlaneMotion(*total)


def point_receivers(
    scene: RockMass, stack: JointStack
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points of a scene [m, d], those on a joint or face shifted into their first block;
    whether each is on a joint [m]; and the counterparts of these on the other side."""
    points = scene.places["points"]
    if not len(points):
        return points, np.zeros(0, dtype=bool), points
    apart = (points @ stack.normal)[:, None] - stack.offsets
    apart = np.take_along_axis(apart, np.abs(apart).argmin(axis=1)[:, None], axis=1)
    sides = sides_at(stack.blocks, points, len(scene.joint_sets))
    inward = stack.blocks.centroid[[min(blocks, default=OUTSIDE) for blocks in sides]] - points
    side = _joint_offset(stack) * np.sign(inward @ stack.normal)[:, None]
    near = np.abs(apart) <= TOLERANCE / OFFSET * _joint_offset(stack)
    here, there = (points + (off - apart) * stack.normal for off in (side, -side))
    on_joint = near[:, 0] & np.array([len(blocks) > 1 for blocks in sides])
    return np.where(near, here, points), on_joint, there[on_joint]


def joint_receivers(scene: RockMass, stack: JointStack) -> np.ndarray:
    """Return a scene's joint receivers [m, d] (m), projected onto the nearest joint."""
    asked = scene.places["joints"]
    if not len(asked):
        return asked
    chosen = contact_at(stack.blocks, asked, len(scene.joint_sets))
    away = stack.blocks.contacts.centroid[chosen] - asked
    return asked + (away @ stack.normal)[:, None] * stack.normal


def frame_of(scene: RockMass) -> np.ndarray:
    """Return the axes of the joints' records [d, d]: the normal, and in the plane the normal
    rotated to the left; in space the normal that points up (else north or east), strike and dip
    line."""
    n = next(iter(normals_of(scene)), np.eye(scene.domain.dimension)[-1])
    if not scene.in_space:
        return np.array([n, [-n[1], n[0]]])
    up = n * np.sign(n[np.flatnonzero(np.abs(n) > PARALLEL)[-1]])
    return np.concatenate([up[None], *frames(up[None])])


def on_face(stress: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return tractions [m, d, n] on a plane with unit normal; stress : [m, components, n]."""
    return np.einsum("mijn,j->min", stress[:, COMPONENT[len(normal)]], normal)


def _joint_offset(stack: JointStack) -> float:
    """Return the offset from a joint of places beside it, m."""
    return OFFSET * float(np.linalg.norm(np.ptp(stack.blocks.body.vertices, axis=0)))


def _solver(name: str, label: str, line: Line, one: bool) -> Solver:
    return Solver(
        name=name,
        rock=Rock.JOINTED,
        kinds=("rock mass",),
        dimension=3,
        in_space=True,
        label=label,
        line=line,
        applies=partial(holds, one=one),
        run=partial(solve, name=name),
        distances=DISTANCES,
    )


ONE_JOINT = _solver(
    "oblique-joint", "joint at an angle, exact", thin("#d55e00", 8, (4.5, 8.5)), one=True
)
PARALLEL_JOINTS = _solver(
    "parallel-joints", "parallel joints, exact", thin("#a83200", 8, (9, 18)), one=False
)
