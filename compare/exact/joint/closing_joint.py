"""One joint that stiffens as it closes, between two half-spaces of rock, at normal incidence.

The joint closes by e(s) under the normal stress s = sigma_T + prestress; with the rock's impedance
Z and the incident stress sigma_I (Zhao & Cai, Rock Mech. Rock Eng. 34, 2001)

    (Z / 2) e'(s) sigma_T' = sigma_I - sigma_T,   sigma_R = sigma_T - sigma_I

with the hyperbola of Bandis et al. (1983) e' = 1 / (k_ni (1 + s / (k_ni d_m))^2), or 1 / k_ni in
tension, minus the compliance of the rock without this joint. The transmitted stress is integrated
by Runge-Kutta of order 8 (Dormand & Prince) between the breaks of the load: errors decay, and a run
with a thousand times the tolerance shows their size.

Valid for one such joint without dashpots, in the homogenised bar, like `one_joint`, or as the only
joint in intact rock under a P wave along a periodic strip.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import LoadHistory
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.law_parts import UNLIMITED
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.images import entering
from jointwave.compare.exact.conditions import holds
from jointwave.compare.exact.joint.one_joint import back_in_time, behind_and_before
from jointwave.compare.exact.joint.trajectory import Trajectory, edges_of, peak_of, too_stiff
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin

HELD = ("closure", "prestress", "soft layers", "stiff layers")
TOLERANCES = (1e-12, 1e-9)  # for the solution and its twin, relative to the largest stress


@dataclass(frozen=True)
class ClosingJoint:
    """A joint: y, m; k_ni, Pa/m; d_m, m, inf if linear; compliance of the rock without it, m/Pa;
    prestress, Pa."""

    y: float
    stiffness: float
    maximum: float
    without: float = 0.0
    prestress: float = 0.0

    def closure(self, stress: np.ndarray) -> np.ndarray:
        """Return e (m) at a stress (Pa)."""
        pressed, most = np.maximum(stress, 0.0), self.stiffness * self.maximum
        return (
            pressed / (self.stiffness * (1 + pressed / most))
            + np.minimum(stress, 0.0) / self.stiffness
            - self.without * stress
        )

    def compliance(self, stress: float | np.ndarray) -> np.ndarray:
        """Return de/ds (m/Pa) at a stress (Pa)."""
        share = 1 + np.maximum(stress, 0.0) / (self.stiffness * self.maximum)
        return 1 / (self.stiffness * share**2) - self.without


def applies(scene: Scene) -> Answer:
    """Return whether the waves meet exactly one joint that stiffens within the duration."""
    p = calibrate(scene)
    stiffens = np.zeros(len(p.stiffness), dtype=bool)
    if p.maximum_closure is not None:
        stiffens = p.maximum_closure < UNLIMITED
    answer = holds(
        scene,
        HELD,
        (np.count_nonzero(stiffens) != 1, "not exactly one joint has closure"),
        (bool(p.excess_compliance[~stiffens].any()), "another joint differs in stiffness"),
        (scene.ends.end not in ("quiet", "matched"), "the far end reflects"),
    )
    if not answer:
        return answer
    joint, times = the_joint(scene, p), sample_times(scene)
    most = np.abs(entering(scene).value(times)).max()
    least = float(joint.compliance(joint.prestress + most))
    answer = Answer.unless(
        (least <= 0, "the joint becomes stiffer than the other joints"),
        too_stiff(least, p.impedance, scene.time.duration),
    )
    return answer and back_in_time(scene, joint.y, p.bar_speed)


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement on both sides of the stiffening joint."""
    p, load, times = calibrate(scene), entering(scene), sample_times(scene)
    joint = the_joint(scene, p)
    passed = (Passed(joint, p.impedance, load, times[-1], each) for each in TOLERANCES)
    return behind_and_before(scene, SOLVER.name, joint.y, *passed)


def the_joint(scene: Scene, p: Properties) -> ClosingJoint:
    """Return the only joint that stiffens."""
    assert p.maximum_closure is not None and p.rock_compliance is not None
    j = int(np.argmin(p.maximum_closure))
    own = 1 / p.stiffness[j] - p.rock_compliance[j]
    return ClosingJoint(
        y=float(p.joint_y[j]),
        stiffness=float(1 / own),
        maximum=float(p.maximum_closure[j]),
        without=float(1 / p.regular_stiffness - p.rock_compliance[j]),
        prestress=calibrate(scene).prestress,
    )


class Passed:
    """sigma_T (Pa) and its impulse (Pa s) at any time up to `end` (s), under the incident `load`.

    impedance : Z, Pa s/m. tolerance : of each step, relative to the largest incident stress.
    """

    def __init__(
        self,
        joint: ClosingJoint,
        impedance: float,
        load: LoadHistory,
        end: float,
        tolerance: float = TOLERANCES[0],
    ) -> None:
        self.joint, self.impedance, self.load = joint, impedance, load

        edges, peak = edges_of(load, end), peak_of(load, end)
        self.stress = Trajectory(self._rate, [0.0], edges, tolerance, peak)

    def _rate(self, t: Any, stress: np.ndarray) -> np.ndarray:
        """Return sigma_T' (Pa/s)."""
        off = 2 * (self.load.value(np.atleast_1d(t)) - stress)
        return off / (self.impedance * self.joint.compliance(self.joint.prestress + stress))

    def with_rate(self, times: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_T (Pa) and its rate (Pa/s) at times (s)."""
        t = np.atleast_1d(times)
        stress = self.stress(t)[0]
        return stress, self._rate(t, stress)

    def __call__(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_T (Pa) and its impulse (Pa s) at times (s)."""
        stress, joint = self.stress(times)[0], self.joint
        moved = joint.closure(joint.prestress + stress) - joint.closure(np.array(joint.prestress))
        return stress, self.load.impulse(times) - self.impedance * moved / 2


SOLVER = Solver(
    name="closing-joint",
    rock=Rock.HOMOGENISED,
    label="stiffening joint, exact",
    line=thin("#d55e00", 7, (6, 8.5)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-equivalent": "elements, time stepping, the joint's excess"},
        Kind.MODELLING: {
            "dem": "discrete blocks instead of a homogenised bar",
            "continuum-jointed": "every joint instead of a homogenised bar",
        },
    },
)
