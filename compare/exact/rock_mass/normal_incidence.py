"""Scenes of a plane wave at normal incidence on one joint that is not linear: a P wave under which
it stiffens (`joint.closing_joint`), or an S wave under which it slips (`joint.slip_phases`).

Valid for one such joint without dashpots in undamped rock with sides through which waves leave. The
normal stress on a joint that slips is that of the prestress, which has no shear along it; the joint
may weaken with slip, and does not dilate. P: the stress along the front is nu / (1 - nu) of that
across it.
"""

from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import LoadHistory
from jointwave.cases.incident import PlaneWave, WaveMotion, plane_wave
from jointwave.cases.loads import history_of
from jointwave.cases.partition.joints import attitude
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.law_parts import PARTS, tangent
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.joint import closing_joint, slip_phases
from jointwave.compare.exact.joint.closing_joint import ClosingJoint
from jointwave.compare.exact.joint.one_joint import around
from jointwave.compare.exact.joint.slip_phases import SlipJoint
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.plane.waves import PlaneMotion
from jointwave.compare.exact.rock_mass import stack_waves
from jointwave.compare.exact.rock_mass.conditions import along
from jointwave.compare.exact.rock_mass.stack import JointStack, stack_of
from jointwave.compare.solvers.record import Answer, Rock, Solver, thin

CLOSES = ("maximum_closure",)
WEAKENS = next(part for part in PARTS if part.name == "weakening")
SLIPS = ("friction_angle", "cohesion", *WEAKENS.keys)
BESIDE = 2e-9  # m
ROUND_OFF = 1e-11  # of the largest of a waveform
SHEARED = 1e-9  # of the prestress: less shear along a joint is none


def applies(scene: RockMass) -> Answer:
    """Return whether a P wave meets one joint that stiffens, or an S wave one that slips, at normal
    incidence."""
    sets = scene.joint_sets
    slips = all(wave.kind == "S" for wave in scene.waves)
    keys = (*SLIPS, *CLOSES, "tension") if slips else CLOSES
    if all(getattr(one, key) is None for one in sets for key in (*CLOSES, *SLIPS[:2])):
        return Answer("no joint has closure or can slip: see oblique-joint")
    linear = [one.model_copy(update=dict.fromkeys(keys)) for one in sets]
    answer = stack_waves.holds(scene.model_copy(update={"joint_sets": linear}), one=True)
    if not answer:
        return answer
    if any(one.damping_ratio for one in sets):
        return Answer("the joint is damped")
    wave, normal = scene.waves[0], stack_of(scene).normal
    if len(scene.waves) > 1 or not along(np.array(wave.direction), normal):
        return Answer("the wave is not one at normal incidence")
    return _slips_as_known(scene, sets[0]) if slips else answer


def _slips_as_known(scene: RockMass, one: JointSet) -> Answer:
    """Return whether the slip of a joint under an S wave is that of `slip_phases`."""
    if one.friction_angle is None and one.cohesion is None:
        return Answer("the joint cannot slip under an S wave: see oblique-joint")
    if one.residual_cohesion is not None:
        return Answer("the joint loses cohesion")
    n = attitude(one, scene.domain.dimension)[0]
    carried = scene.prestress.tensor @ n if scene.prestress else 0 * n
    normal = float(n @ carried)
    if np.abs(carried - normal * n).max() > SHEARED * np.abs(carried).max():
        return Answer("the prestress shears the joint")
    if normal < 0 or (normal == 0 and one.tension is False):
        return Answer("no normal stress closes the joint")
    joint = slip_joint(one, normal)
    if joint.fall * joint.compliance >= 1:
        return Answer("friction falls with slip faster than the joint unloads")
    return Answer()


def solve(scene: RockMass) -> xr.Dataset:
    """Return the receivers' records of the wave at the joint."""
    return stack_waves.solve(scene, SOLVER.name, _motion)


def slip_joint(one: JointSet, normal: float, y: float = 0.0) -> SlipJoint:
    """Return a joint at y (m) under a normal stress (Pa), as `slip_phases` has it."""
    cohesion, friction = one.cohesion or 0.0, tangent(one.friction_angle)
    assert one.shear_stiffness
    distance, left = WEAKENS.parameters(one)
    strength, dynamic = (cohesion + share * normal for share in (friction, left))
    return SlipJoint(y, 1 / one.shear_stiffness, strength, dynamic, distance)


class NormalField:
    """The wave of a scene with reflection and transmission: `cases.incident.IncidentField`.

    which : 1 for the twin, whose tolerances are larger.
    """

    def __init__(self, scene: RockMass, which: int = 0) -> None:
        wave, stack = scene.waves[0], stack_of(scene)
        self.wave = plane_wave(scene, wave)
        self.impedance = float(self.wave.rock.density) * self.wave.speed
        self.y = float(self.wave.direction @ (stack.offsets[0] * stack.normal - self.wave.through))
        over = 1.0 if wave.quantity == "stress" else self.impedance
        self.load = history_of(wave, wave.amplitude * over)
        extent = np.linalg.norm(np.ptp(np.array(scene.domain.corners), axis=0))
        end = scene.time.duration + float(extent / self.wave.speed)
        self.passed = passed_of(scene, self.wave, self.y, self.load, end, which)

    def waves(self, points: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the waves to and fro [2, stress and impulse, m, n]; Pa, against the motion of the
        first."""
        y, joint = (np.asarray(points) - self.wave.through) @ self.wave.direction, self.y
        # On one side of the joint, not on it, where velocity and stress along it have no one value.
        y = joint + np.copysign(np.maximum(np.abs(y - joint), BESIDE), y - joint)
        return around(joint, self.wave.speed, self.passed, self.load, np.asarray(times), y)

    def motion(self, points: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return displacement and velocity [m, d, n], and stress [m, components, n] in Pa, tension
        positive."""
        there, back = self.waves(points, times)
        velocity, moved = (
            (there - back)[:, :, None] / self.impedance * self.wave.polarisation[:, None]
        )
        unit = self.wave.unit_stress() / self.impedance
        return moved, velocity, (there[0] + back[0])[:, None] * unit[:, None]

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        return WaveMotion(*self.motion(points, times)[1:])


def passed_of(
    scene: RockMass, wave: PlaneWave, y: float, load: LoadHistory, end: float, which: int
) -> Any:
    """Return what passes the joint of a scene at y (m) along a wave, up to `end` (s)."""
    one, n = scene.joint_sets[0], wave.direction
    impedance = float(wave.rock.density) * wave.speed
    normal = float(n @ scene.prestress.tensor @ n) if scene.prestress else 0.0
    if scene.waves[0].kind == "S":
        slides, tolerance = slip_joint(one, normal, y), slip_phases.TOLERANCES[which]
        return slip_phases.Passed(slides, impedance, load, end, tolerance)
    assert one.normal_stiffness and one.maximum_closure
    closes = ClosingJoint(y, one.normal_stiffness, one.maximum_closure, prestress=normal)
    return closing_joint.Passed(closes, impedance, load, end, closing_joint.TOLERANCES[which])


def _motion(
    scene: RockMass, stack: JointStack, places: np.ndarray, times: np.ndarray
) -> PlaneMotion:
    """Return the motion at places [m, d] (m), displacement relative to the start of the scene."""
    found = []
    for which in (0, 1):
        moved, *others = NormalField(scene, which).motion(places, times)
        found.append((moved - moved[..., :1], *others))
    errors = (
        bound(one, twin) + ROUND_OFF * np.abs(one).max(initial=0.0)
        for one, twin in zip(*found, strict=True)
    )
    return PlaneMotion(*found[0], *errors)


SOLVER = Solver(
    name="normal-incidence",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=3,
    in_space=True,
    label="nonlinear joint, plane wave, exact",
    line=thin("#d55e00", 8, (4.5, 8.5)),
    applies=applies,
    run=solve,
    distances=stack_waves.DISTANCES,
)
