"""Criteria at the critical step: stable below, bounded on it, caught above."""

import re
from math import acosh, ceil, inf, log, sqrt
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import trapezoid

from cases.errors import SceneError, UnstableError
from cases.loads import load_history
from cases.sampling import sample_times
from compare.experiments.robustness.case import ALLOW, CaseTrial, Judgement, criterion

RANGE = log(1.7e308) - log(2.2e-308)  # of all numbers, from the smallest to the largest


def exactly(trial: CaseTrial, steps: int) -> dict[str, Any]:
    """Return the changes for one sample per step, of exactly the requested fraction."""
    dt = trial.dt
    return {"record__interval": dt, "time__duration": dt * steps * (1 + 1e-9)}


@criterion("highest velocity, m/s, at most that of the impulse at this step")
def impulse_bound(trial: CaseTrial) -> Judgement:
    """No point moves faster than the load's impulse allows, with the amplification at this step.

    A mode of frequency omega, driven at steps k by F_k, has the velocity (leapfrog in closed form)
    v_j = (dt/m) sum F_k cos((j - k - 1/2) W dt) / cos(W dt/2), with cos(W dt/2) = sqrt(1 - x^2)
    and x = omega dt / 2. So |v| in the norm of the mass is at most I s / sqrt(1 - x^2), I the
    integral of |F| and s = 1 / sqrt(m) of the loaded point; at x = 1 the mode alternates and grows
    by at most 2 I s a step. The highest x is the step over the critical one.
    """
    steps = STEPS if trial.fraction < 1 else STEPS_AT_THE_CRITICAL
    result = trial.run(**exactly(trial, steps))
    x = _over_critical(result)
    gain = _gain_of_composition(x, steps) if _is_fourth(trial) else _gain(x, steps)
    said = f"step {x:.6f} of the critical; speeds in m/s"
    return Judgement(_speed(trial, result), gain * _fastest(trial), said)


STEPS = 20_000
STEPS_AT_THE_CRITICAL = 2000  # before linear growth is more than the divergence monitor allows


def _gain(x: float, steps: int) -> float:
    """Return the largest amplification of a velocity by leapfrog, at x of the critical step."""
    return 2.0 * steps if x >= 1 - 1e-9 else min(2.0 * steps, 1 / sqrt(1 - x * x))


def _speed(trial: CaseTrial, result: xr.Dataset) -> float:
    """Return the highest recorded speed, m/s, of leapfrog at half steps, where it has velocities:
    the mean of two of them would hide a mode that alternates."""
    if _is_fourth(trial):
        return float(np.abs(result["velocity"].values).max())
    ways = np.diff(result["displacement"].values, axis=1)
    return float(np.abs(ways).max()) / float(result.attrs["dt"])


def _is_fourth(trial: CaseTrial) -> bool:
    return trial.scheme == "fourth-order"


def _gain_of_composition(x: float, steps: int) -> float:
    """Return the fourth-order scheme's largest gain of a velocity, at x of its critical step.

    One step of (omega u, v) is M of determinant one with equal diagonal entries cos W, so
    M^j = [[cos jW, b s], [c s, cos jW]] with s = sin jW / sin W, at most j. A kick in the middle
    of a step leaves the step as w: |v_j| <= |w_v| + |c w_u s|.
    """
    from dem.axial.fourth_order import DRIFTS, KICKS, stability_limit

    z = min(x, 1.0) * stability_limit()
    drifts = [np.array([[1.0, a * z], [0.0, 1.0]]) for a in DRIFTS]
    kicks = [np.array([[1.0, 0.0], [-b * z, 1.0]]) for b in KICKS]
    after, left = drifts[-1], [drifts[-1][:, 1]]
    for kick, drift in zip(kicks[:0:-1], drifts[-2:0:-1], strict=True):
        after = after @ kick @ drift
        left.append(after[:, 1])
    whole = after @ kicks[0] @ drifts[0]
    turn = sqrt(max(1 - whole[0, 0] ** 2, 0.0))
    most = steps if turn * steps < 1 else 1 / turn
    return float(max(abs(v) + abs(whole[1, 0] * u) * most for u, v in left))


def _fastest(trial: CaseTrial) -> float:
    """Return the speed (m/s) of the lightest node after the impulse of the load's magnitude.

    A block has its whole mass on its one freedom. GLL elements of order p give 1 / (p (p + 1)) of
    theirs to a node at their end.
    """
    scene, p, times = trial.scene, trial.properties, sample_times(trial.scene)
    impulse = p.area * trapezoid(np.abs(load_history(scene).value(times)), times)
    if trial.engine.has_rigid_blocks:
        return impulse / p.block_mass
    n = scene.numerics.continuum
    mass = p.block_mass / (n.elements_per_block or 1) / (n.order * (n.order + 1))
    return impulse / mass


@criterion("refused; forced, stopped before overflow")
def caught(trial: CaseTrial) -> Judgement:
    """A step above the critical one is refused; forced, it is stopped within the range of numbers.

    The highest mode grows by exp(2 acosh(x)) a step (leapfrog; the fourth-order scheme by
    exp(acosh |h|), h half the trace of its step). It cannot stay finite for longer than from the
    smallest to the largest number.
    """
    x = trial.fraction
    steps = ceil(RANGE / _growth(trial, x))
    changes = exactly(trial, steps * 3 // 2)
    try:
        trial.run(**changes)
        return Judgement(inf, steps, "the step was not refused")
    except SceneError:
        pass
    try:
        trial.run(**changes, **{ALLOW: True})
    except UnstableError as error:
        message = str(error)
        found = re.search(r"t = ([-+.\de]+) s", message)
        assert found is not None, message
        return Judgement(round(float(found[1]) / trial.dt), 2 * steps, f"steps; {error}")
    return Judgement(inf, 2 * steps, "the run was not stopped")


def _growth(trial: CaseTrial, x: float) -> float:
    """Return the logarithm of the mode's amplification in a step at x of the critical one."""
    if not _is_fourth(trial):
        return 2 * acosh(x)
    from dem.axial.fourth_order import half_trace, stability_limit

    return acosh(abs(half_trace()((x * stability_limit()) ** 2)))


@criterion("energy after the load, over that at its end")
def never_grows(trial: CaseTrial) -> Judgement:
    """Once the load has ended, implicit steps of any length never add energy.

    The generalised-alpha method is unconditionally stable and its modes only decay: the most of
    the second half of the run is no more than that of the first, up to round-off of every step.
    """
    result = trial.result
    energy = result["energy"].sel(term=["kinetic", "elastic"]).sum("term").values
    after = energy[result["time"].values > 3 * (trial.scene.load.period or 0.0)]
    half = after.size // 2
    ratio = float(after[half:].max() / after[:half].max())
    bound = 1 + 1e-14 * float(result.attrs["steps"])
    return Judgement(ratio, bound, f"step {_over_critical(result):.3g} critical ones")


def _over_critical(result: xr.Dataset) -> float:
    return float(result.attrs["dt"]) / float(result.attrs["critical_dt"])
