"""Scenes of plane waves at normal incidence on one nonlinear joint: a P wave that makes it stiffen
(`joint.closing_joint`), and an S wave that makes it slip (`joint.slip_phases`).

Valid for one such joint without dashpots in undamped rock with sides through which waves leave, and
at most one wave of each kind. The prestress may shear the joint along the motion of the S wave, by
less than its strength; the joint may weaken with slip or lose cohesion, and does not dilate. The P
wave changes its normal stress, which stays compressive. The P wave's stress along the front is nu /
(1 - nu) of that across it.
"""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.histories import LoadHistory
from jointwave.cases.incident import PlaneWave, WaveMotion, plane_wave
from jointwave.cases.loads import history_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.law_parts import PARTS, tangent
from jointwave.cases.schema.pulse import Wave
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.joint import closing_joint, slip_phases
from jointwave.compare.exact.joint.closing_joint import ClosingJoint
from jointwave.compare.exact.joint.one_joint import around
from jointwave.compare.exact.joint.slip_phases import Pressed, SlipJoint
from jointwave.compare.exact.joint.trajectory import peak_of, too_stiff
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.plane.waves import PlaneMotion
from jointwave.compare.exact.rock_mass import stack_waves
from jointwave.compare.exact.rock_mass.conditions import along
from jointwave.compare.exact.rock_mass.stack import JointStack, stack_of
from jointwave.compare.solvers.record import Answer, Rock, Solver, thin

CLOSES = ("maximum_closure",)
WEAKENS = next(part for part in PARTS if part.name == "weakening")
SLIPS = ("friction_angle", "cohesion", "residual_cohesion", *WEAKENS.keys)
BESIDE = 2e-9  # m
ROUND_OFF = 1e-11  # over the largest value of a waveform
SHEARED = 1e-9  # shear along a joint over the prestress that is neglected
LINEAR = np.inf  # m, maximum closure of a linear joint


def applies(scene: RockMass) -> Answer:
    """Return whether waves meet one joint at normal incidence that stiffens or slips."""
    sets, waves = scene.joint_sets, {one.kind: one for one in scene.waves}
    keys = (*SLIPS, *CLOSES, "tension") if "S" in waves else CLOSES
    if all(getattr(one, key) is None for one in sets for key in (*CLOSES, *SLIPS[:2])):
        return Answer("no joint has closure or can slip: see oblique-joint")
    linear = [one.model_copy(update=dict.fromkeys(keys)) for one in sets]
    answer = stack_waves.holds(scene.model_copy(update={"joint_sets": linear}), one=True)
    if not answer:
        return answer
    normal = stack_of(scene).normal
    oblique = not all(along(np.array(one.direction), normal) for one in scene.waves)
    ways = {np.sign(normal @ one.direction) for one in scene.waves}
    answer = Answer.unless(
        *(_too_stiff(scene, one) for one in scene.waves),
        (any(one.is_damped for one in sets), "the joint is damped"),
        (oblique, "a wave is not one at normal incidence"),
        (len(waves) < len(scene.waves), "several waves are of one kind"),
        (len(ways) > 1, "waves meet the joint from both sides"),
    )
    return answer and _slips_as_known(scene, sets[0]) if "S" in waves else answer


def _too_stiff(scene: RockMass, wave: Wave) -> tuple[bool, str]:
    """Return `too_stiff` of the joint that a wave makes stiffen or slip."""
    one, met = scene.joint_sets[0], plane_wave(scene, wave)
    K = one.shear_stiffness if wave.kind == "S" else one.maximum_closure and one.normal_stiffness
    return too_stiff(1 / K if K else 0.0, float(met.rock.density) * met.speed, scene.time.duration)


def _slips_as_known(scene: RockMass, one: JointSet) -> Answer:
    """Return whether `slip_phases` covers the slip of a joint under an S wave."""
    if one.friction_angle is None and one.cohesion is None:
        return Answer("the joint cannot slip under an S wave: see oblique-joint")
    wave = next(plane_wave(scene, each) for each in scene.waves if each.kind == "S")
    normal, shear, across = carried(scene, wave)
    if across > SHEARED * (abs(normal) + abs(shear)):
        return Answer("the prestress shears the joint across the motion of the S wave")
    least = normal - sum(
        peak_of(NormalWave.of(scene, each).load, scene.time.duration)
        for each in scene.waves
        if each.kind == "P"
    )
    if least < 0 or (least == 0 and one.tension is False):
        return Answer("no normal stress closes the joint at all times")
    joint = slip_joint(one, normal, shear)
    most = joint.fall + joint.friction_fall * (normal - least)
    snaps = most * joint.compliance >= 1
    return Answer.unless(
        (joint.left(0.0) <= abs(shear) and shear, "the prestress exceeds the joint's strength"),
        (snaps, "friction falls with slip faster than the joint unloads"),
    )


def carried(scene: RockMass, wave: PlaneWave) -> tuple[float, float, float]:
    """Return the joint's initial stress for an S wave, Pa: normal stress, shear along the motion of
    the wave, and the remaining shear."""
    if scene.prestress is None:
        return 0.0, 0.0, 0.0
    n, g = wave.direction, wave.polarisation
    traction = scene.prestress.tensor @ n
    normal, shear = float(n @ traction), float(g @ traction)
    return normal, shear, float(np.abs(traction - normal * n - shear * g).max())


def solve(scene: RockMass) -> xr.Dataset:
    """Return the records of all receivers for the waves at the joint."""
    return stack_waves.solve(scene, SOLVER.name, _motion)


def slip_joint(one: JointSet, normal: float, shear: float = 0.0, y: float = 0.0) -> SlipJoint:
    """Return a joint at y (m) under initial normal and shear stress (Pa) for `slip_phases`."""
    cohesion, friction = one.cohesion or 0.0, tangent(one.friction_angle)
    assert one.shear_stiffness
    distance, left = WEAKENS.parameters(one)
    strength, dynamic = (cohesion + share * normal for share in (friction, left))
    lost = 0.0 if one.residual_cohesion is None else max(cohesion - one.residual_cohesion, 0.0)
    return SlipJoint(
        y, 1 / one.shear_stiffness, strength, dynamic, distance,
        friction=friction, dynamic_friction=left, carried=shear, lost=lost,
    )  # fmt: skip


class NormalWave(NamedTuple):
    """A wave of a scene, the rock's impedance for it, Pa s/m, the joint's place along it, m, and
    its incident stress as a function of time."""

    wave: PlaneWave
    impedance: float
    y: float
    load: LoadHistory

    @classmethod
    def of(cls, scene: RockMass, one: Wave) -> "NormalWave":
        """Return a wave of a scene with one joint."""
        wave, stack = plane_wave(scene, one), stack_of(scene)
        impedance = float(wave.rock.density) * wave.speed
        y = float(wave.direction @ (stack.offsets[0] * stack.normal - wave.through))
        over = 1.0 if one.quantity == "stress" else impedance
        return cls(wave, impedance, y, history_of(one, one.amplitude * over))

    @property
    def arrival(self) -> float:
        """Arrival time at the joint, s."""
        return self.y / self.wave.speed


class NormalField:
    """The waves of a scene with reflection and transmission (an `IncidentField`).

    which : 1 for the twin with larger tolerances.
    """

    def __init__(self, scene: RockMass, which: int = 0) -> None:
        met = [NormalWave.of(scene, one) for one in sorted(scene.waves, key=lambda one: one.kind)]
        extent = np.linalg.norm(np.ptp(np.array(scene.domain.corners), axis=0))
        end = scene.time.duration + float(extent) / min(one.wave.speed for one in met)
        self.parts: list[tuple[NormalWave, Any]] = []
        for one, kind in zip(met, sorted(each.kind for each in scene.waves), strict=True):
            if kind == "P":
                passed: Any = _closing(scene, one, end - one.arrival, which)
            else:
                pressed = _pressed(one, *self.parts[0]) if self.parts else Pressed()
                passed = _slipping(scene, one, end - one.arrival, which, pressed)
            self.parts.append((one, passed))

    def motion(self, points: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return displacement and velocity [m, d, n], and stress [m, components, n] as a
        `WaveMotion`."""
        found = [_around(*part, np.asarray(points), np.asarray(times)) for part in self.parts]
        return tuple(np.sum(each, axis=0) for each in zip(*found, strict=True))

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        return WaveMotion(*self.motion(points, times)[1:])


def _around(
    met: NormalWave, passed: Any, points: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return the motion of one wave, as `NormalField.motion` does."""
    y, joint, wave = (points - met.wave.through) @ met.wave.direction, met.y, met.wave
    # Move places off the joint, on which velocity and tangential stress are not unique.
    y = joint + np.copysign(np.maximum(np.abs(y - joint), BESIDE), y - joint)
    there, back = around(joint, wave.speed, passed, met.load, times, y)
    velocity, moved = (there - back)[:, :, None] / met.impedance * wave.polarisation[:, None]
    unit = wave.unit_stress() / met.impedance
    return moved, velocity, (there[0] + back[0])[:, None] * unit[:, None]


def _closing(scene: RockMass, met: NormalWave, end: float, which: int) -> closing_joint.Passed:
    """Return the transmission of a P wave through the joint of a scene up to `end` (s)."""
    one, n = scene.joint_sets[0], met.wave.direction
    assert one.normal_stiffness
    normal = float(n @ scene.prestress.tensor @ n) if scene.prestress else 0.0
    most = one.maximum_closure or LINEAR
    closes = ClosingJoint(met.y, one.normal_stiffness, most, prestress=normal)
    tolerance = closing_joint.TOLERANCES[which]
    return closing_joint.Passed(closes, met.impedance, met.load, end, tolerance)


def _pressed(shears: NormalWave, met: NormalWave, passed: closing_joint.Passed) -> Pressed:
    """Return the pressure that a P wave adds on the joint, over the time of an S wave there."""
    late = shears.arrival - met.arrival
    breaks = [t - late for t in met.load.breaks]
    return Pressed(lambda t: passed.with_rate(np.asarray(t) + late), breaks)


def _slipping(
    scene: RockMass, met: NormalWave, end: float, which: int, pressed: Pressed
) -> slip_phases.Passed:
    """Return the transmission of an S wave through the joint of a scene up to `end` (s)."""
    normal, shear, _ = carried(scene, met.wave)
    joint = slip_joint(scene.joint_sets[0], normal, shear, met.y)
    tolerance = slip_phases.TOLERANCES[which]
    return slip_phases.Passed(joint, met.impedance, met.load, end, tolerance, pressed=pressed)


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
