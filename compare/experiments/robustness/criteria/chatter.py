"""Repeated impact: a loose block between two walls, ten thousand times.

The walls are the outer blocks on their stiff half-block springs; the joints to the loose one, a
millionth as stiff, carry no tension. On one of them the block is a damped oscillator, omega =
sqrt(k/m), whose damping ratio is the joint's own, until the force of spring and dashpot together
is zero. That is at omega_d t = pi - 2 asin(zeta), where the speed over that of the approach is

    e = exp(-zeta (pi - 2 asin(zeta)) / sqrt(1 - zeta^2))

(Schwager & Poeschel, Granular Matter 9, 2007, of the same contact).
"""

from math import asin, inf, isfinite, log, pi, sqrt

import numpy as np

from cases.errors import UnstableError
from compare.experiments.robustness.case import CaseTrial, Judgement, criterion
from compare.experiments.robustness.map import unloaded

IMPACTS = 10_000
SAMPLES = 16  # of the speed, from one impact to the next
#: Relative, of the largest of the speeds sampled between impacts.
EDGE = 1 - np.cos(pi / SAMPLES / 2)


@criterion("logarithm of the last speed over the first, off that of ten thousand dashpots' impacts")
def restitution(trial: CaseTrial) -> Judgement:
    """After n impacts the speed is e^n of the first, and it never grows.

    An impact begins and ends within a step, where the trapezoid of the force is off by k (v dt)^2/8
    at most: a share (omega dt)^2 / 4 of m v^2 / 2, so half of that of the speed, at either end. The
    walls give way by the ratio r of the stiffnesses, which changes a half period by r / 2.
    """
    p, (layer, _) = trial.properties, trial.scene.soft_layers
    omega = sqrt(p.stiffness[p.soft[0]] * p.area / p.block_mass)
    peaks = _peaks(trial, max(1, round(pi / omega / trial.dt / SAMPLES)))
    zeta = layer.damping_ratio or 0.0
    e = -zeta * (pi - 2 * asin(zeta)) / sqrt(1 - zeta**2)
    kinks = (omega * trial.dt) ** 2 / 4
    rise = float((peaks[1:] / np.minimum.accumulate(peaks)[:-1]).max()) - 1
    off = abs(log(peaks[-1] / peaks[0]) - (len(peaks) - 1) * e)
    softer = float(p.stiffness[p.soft[0]] / p.regular_stiffness)
    bound = (len(peaks) - 1) * (kinks + abs(e) * softer) + EDGE
    if rise > 2 * kinks + EDGE:
        return Judgement(inf, bound, f"the speed grows by {rise:.3g} at an impact")
    said = f"after {len(peaks) - 1:,} impacts; e^n = {peaks[-1] / peaks[0]:.4f}"
    return Judgement(off, bound, said)


def _peaks(trial: CaseTrial, stride: int) -> np.ndarray:
    """Return the largest speed of the loose block's mass between successive impacts, m/s, of all
    impacts, from 1 m/s on; sampled every `stride` steps."""
    body = unloaded(trial.engine, trial.scene)
    loose, start = body.second, np.zeros(body.mass.size)
    start[loose] = 1.0
    (moving, advance), mass = body.begin(trial.dt, start), body.mass[loose]
    total = mass.sum()

    def speed() -> float:
        return float(mass @ moving[loose] / total)

    peaks: list[float] = []
    largest, sign = abs(speed()), 1.0
    while len(peaks) <= IMPACTS:
        advance(stride)
        v = speed()
        if not isfinite(v):
            said = f"the loose block's velocity is not finite after {len(peaks):,} impacts"
            raise UnstableError(said)
        if v * sign < 0:
            peaks.append(largest)
            largest, sign = 0.0, -sign
        largest = max(largest, abs(v))
    return np.array(peaks)
