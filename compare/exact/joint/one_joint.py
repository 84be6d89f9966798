"""One linear joint between two half-spaces of rock of impedance Z.

Harmonic waves, kappa = K/(Z omega): |T| = 2 kappa/sqrt(4 kappa^2 + 1), |R| = 1/sqrt(4 kappa^2 + 1);
with a dashpot c_j, K becomes K + i omega c_j (Schoenberg, JASA 68, 1980; Pyrak-Nolte, Myer & Cook,
JGR 95, 1990). In time (Z/2K) sigma_T' + sigma_T = sigma_I, sigma_R = sigma_T - sigma_I. A dashpot
of time constant eta passes the share eta/tau without delay and smooths the rest, tau = eta + Z/2K:

    sigma_T = (eta/tau) sigma_I + (1 - eta/tau) s,   tau s' + s = sigma_I

Valid for the homogenised bar without rock damping, with one soft layer and a quiet or matched far
end; with a free start only until the layer's reflection has been reflected there and has reached a
receiver. On the layer, velocity is the mean of both sides.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.histories import LoadHistory
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.images import entering
from jointwave.compare.exact.conditions import holds
from jointwave.compare.exact.linear import bound, twins
from jointwave.compare.solvers.record import Answer, Rock, Solver, thin
from jointwave.results.dataset import dataset

Passes = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
HELD = ("prestress", "damped joints", "soft layers", "stiff layers")
NEAR = 1e-9  # m, distance below which a place is on the joint


class Joint(NamedTuple):
    """A joint: y (m), stiffness K (Pa/m) and time constant eta (s)."""

    y: float
    stiffness: float
    time_constant: float


def applies(scene: Scene) -> Answer:
    """Return whether the waves meet exactly one joint within the scene's duration."""
    p = calibrate(scene)
    compliance = p.excess_compliance
    answer = holds(
        scene,
        HELD,
        (np.count_nonzero(compliance) != 1, "not exactly one joint differs in stiffness"),
        (bool((compliance < 0).any()), "the layer is stiffer than the other joints"),
        (bool(p.damps_alone.any()), "another joint has a dashpot"),
        (scene.ends.end not in ("quiet", "matched"), "the far end reflects"),
    )
    return answer if not answer else back_in_time(scene, the_joint(p).y, p.bar_speed)


def back_in_time(scene: Scene, joint_y: float, speed: float) -> Answer:
    """Return whether no reflection from a joint at y (m) returns from a free start in time."""
    nearest = min([*scene.record.stress, *scene.record.velocity])
    back = (2 * joint_y + nearest) / speed
    if scene.ends.start != "free" or back >= scene.time.duration:
        return Answer()
    return Answer(f"the free start reflects back to a receiver at {back:.4g} s")


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement on both sides of the scene's soft layer."""
    p, load = calibrate(scene), entering(scene)
    joint = the_joint(p)
    passed, twin = (partial(transmitted, joint, p.impedance, load, which=which) for which in (0, 1))
    return behind_and_before(scene, SOLVER.name, joint.y, passed, twin)


def behind_and_before(
    scene: Scene, name: str, joint_y: float, passed: Passes, twin: Passes
) -> xr.Dataset:
    """Return a solver's result for a joint at y (m) with the transmission `passed` (see `around`);
    twin : a second computation, whose difference bounds the error."""
    p, load, times = calibrate(scene), entering(scene), sample_times(scene)
    found = []
    for one in (passed, twin):
        (stress, stress_back), (motion, motion_back) = (
            around(joint_y, p.bar_speed, one, load, times, places)
            for places in (scene.record.stress, scene.record.velocity)
        )
        stress = stress[0] + stress_back[0] + calibrate(scene).prestress
        found.append([stress, *((motion - motion_back) / p.impedance)])
    names = "stress", "velocity", "displacement"
    waves, bounds = (dict(zip(names, of, strict=True)) for of in (found[0], map(bound, *found)))
    return dataset(scene, name, times, waves, errors=bounds)


def around(
    joint_y: float,
    speed: float,
    passed: Passes,
    load: LoadHistory,
    times: np.ndarray,
    places: list[float] | np.ndarray,
) -> np.ndarray:
    """Return the waves in front of, on and behind a joint between half-spaces, [there and back,
    stress and impulse, place, time].

    passed : sigma_T (Pa) and its impulse (Pa s) at times at the joint (s), in equally spaced rows,
    under the incident stress `load`; joint_y, places in m, speed in m/s.
    """
    y = np.asarray(places, dtype=float)[:, None]
    behind, on = y > joint_y + NEAR, np.abs(y - joint_y) <= NEAR
    direct, late = times - y / speed, times - np.where(behind, y, 2 * joint_y - y) / speed
    there, incident = (np.array([load.value(t), load.impulse(t)]) for t in (direct, late))
    after, before = np.array(passed(late)), np.where(behind, 0.0, np.where(on, 0.5, 1.0))
    return np.array([after + before * (there - after), before * (after - incident)])


def the_joint(p: Properties) -> Joint:
    """Return the only joint whose stiffness differs from the ordinary ones."""
    compliance = p.excess_compliance
    j = int(np.flatnonzero(compliance)[0])
    return Joint(float(p.joint_y[j]), 1 / compliance[j], float(p.excess_time_constant[j]))


def transmitted(
    joint: Joint, impedance: float, load: LoadHistory, times: np.ndarray, which: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_T (Pa) and its impulse (Pa s) at the joint for the incident stress `load`.

    times : equally spaced from before the load begins, [n] or rows. which : 1 for the twin.
    """
    tau = joint.time_constant + impedance / (2 * joint.stiffness)
    share = joint.time_constant / tau
    rate, one = np.array([[-1 / tau]]), np.ones(1)
    rows = times.reshape(-1, times.shape[-1])
    smooth = np.array([twins(rate, one / tau, load, row)[which, :, 0] for row in rows])
    smooth = smooth.reshape(times.shape)
    stress = share * load.value(times) + (1 - share) * smooth
    impulse = load.impulse(times) - (1 - share) * tau * smooth
    return stress, impulse


SOLVER = Solver(
    name="one-joint",
    rock=Rock.HOMOGENISED,
    label="one joint, exact",
    line=thin("#d55e00", 7, (6, 8.5)),
    applies=applies,
    run=solve,
)
