"""Scenes of a P wave at normal incidence on one joint that stiffens (`joint.closing_joint`).

Valid for one such joint that does not slide, open or damp, in undamped rock with sides through
which waves leave. The stress along the front is nu / (1 - nu) of that across it.
"""

import numpy as np
import xarray as xr

from jointwave.cases.incident import WaveMotion, in_components, plane_wave
from jointwave.cases.loads import history_of
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.joint.closing_joint import TOLERANCES, ClosingJoint, Passed
from jointwave.compare.exact.joint.one_joint import around
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.plane.waves import PlaneMotion
from jointwave.compare.exact.rock_mass import stack_waves
from jointwave.compare.exact.rock_mass.conditions import along
from jointwave.compare.exact.rock_mass.stack import JointStack, stack_of
from jointwave.compare.solvers.record import Answer, Rock, Solver, thin


def applies(scene: RockMass) -> Answer:
    """Return whether a P wave meets one joint that stiffens at normal incidence."""
    if all(one.maximum_closure is None for one in scene.joint_sets):
        return Answer("no joint has closure: see oblique-joint")
    linear = [one.model_copy(update={"maximum_closure": None}) for one in scene.joint_sets]
    answer = stack_waves.holds(scene.model_copy(update={"joint_sets": linear}), one=True)
    if not answer:
        return answer
    if any(one.damping_ratio for one in scene.joint_sets):
        return Answer("the joint is damped")
    wave, normal = scene.waves[0], stack_of(scene).normal
    if len(scene.waves) > 1 or wave.kind != "P" or not along(np.array(wave.direction), normal):
        return Answer("the wave is not a P wave at normal incidence")
    return answer


def solve(scene: RockMass) -> xr.Dataset:
    """Return the receivers' records of the wave at the joint."""
    return stack_waves.solve(scene, SOLVER.name, _motion)


BESIDE = 2e-9  # m


class ClosingField:
    """The wave of a scene with reflection and transmission: `cases.incident.IncidentField`."""

    def __init__(self, scene: RockMass, tolerance: float = TOLERANCES[0]) -> None:
        wave, one = scene.waves[0], scene.joint_sets[0]
        stack, rock = stack_of(scene), elastic_rock(scene.rock)
        self.wave = plane_wave(scene, wave)
        self.share = float(rock.lame / (rock.p_impedance * rock.p_speed))
        n = self.wave.direction
        assert one.normal_stiffness and one.maximum_closure
        self.joint = ClosingJoint(
            y=float(n @ (stack.offsets[0] * stack.normal - self.wave.through)),
            stiffness=one.normal_stiffness,
            maximum=one.maximum_closure,
            prestress=float(n @ scene.prestress.tensor @ n) if scene.prestress else 0.0,
        )
        self.impedance = float(rock.p_impedance)
        over = 1.0 if wave.quantity == "stress" else self.impedance
        self.load = history_of(wave, wave.amplitude * over)
        extent = np.linalg.norm(np.ptp(np.array(scene.domain.corners), axis=0))
        end = scene.time.duration + float(extent / self.wave.speed)
        self.passed = Passed(self.joint, self.impedance, self.load, end, tolerance=tolerance)

    def waves(self, points: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the waves to and fro [2, stress and impulse, m, n]; Pa, compression positive."""
        y, joint = (np.asarray(points) - self.wave.through) @ self.wave.direction, self.joint.y
        # On one side of the joint, not on it, where velocity and stress along it have no one value.
        y = joint + np.copysign(np.maximum(np.abs(y - joint), BESIDE), y - joint)
        return around(joint, self.wave.speed, self.passed, self.load, np.asarray(times), y)

    def stress(self, across: np.ndarray) -> np.ndarray:
        """Return stress [m, components, n], tension positive, from that on the fronts [m, n]."""
        n, share = self.wave.direction, self.share
        unit = share * np.eye(len(n)) + (1 - share) * np.outer(n, n)
        return -across[:, None] * in_components(unit)[:, None]

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        (there, _), (back, _) = self.waves(points, times)
        velocity = (there - back)[:, None] / self.impedance * self.wave.direction[:, None]
        return WaveMotion(velocity, self.stress(there + back))


def _motion(
    scene: RockMass, stack: JointStack, places: np.ndarray, times: np.ndarray
) -> PlaneMotion:
    """Return the motion at places [m, d] (m), displacement relative to the start of the scene."""
    found = []
    for tolerance in TOLERANCES:
        field = ClosingField(scene, tolerance)
        there, back = field.waves(places, times)
        velocity, moved = (
            (there - back)[:, :, None] / field.impedance * field.wave.direction[:, None]
        )
        found.append((moved - moved[..., :1], velocity, field.stress(there[0] + back[0])))
    errors = (bound(one, twin) for one, twin in zip(*found, strict=True))
    return PlaneMotion(*found[0], *errors)


SOLVER = Solver(
    name="normal-incidence",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=3,
    in_space=True,
    label="stiffening joint, plane wave, exact",
    line=thin("#d55e00", 8, (4.5, 8.5)),
    applies=applies,
    run=solve,
    distances=stack_waves.DISTANCES,
)
