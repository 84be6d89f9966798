"""Criteria of energy over very many steps: no drift, no trend, no growth."""

from math import sqrt
from typing import NamedTuple

import numpy as np
import xarray as xr

from compare.experiments.robustness.case import EPS, CaseTrial, Criterion, Judgement, criterion

SAMPLES = 1000


class Drift(NamedTuple):
    """Kinetic and elastic energy over the mean, minus one [n], after `steps` steps [n]."""

    steps: np.ndarray
    energy: np.ndarray


def drift(trial: CaseTrial, steps: int) -> Drift:
    """Return the energy of an undamped pillar over these steps, from the end of its load on."""
    dt, stride = trial.dt, steps // SAMPLES
    found = {"record__interval": stride * dt, "time__duration": steps * dt * (1 + 1e-9)}
    if trial.is_implicit:
        found["numerics__continuum__steps_per_period"] = trial.period / dt
    result = trial.run(**found)
    energy = result["energy"].sel(term=["kinetic", "elastic"]).sum("term").values
    after = result["time"].values > 3 * trial.period
    mean = energy[after].mean()
    return Drift(result["time"].values[after] / float(result.attrs["dt"]), energy[after] / mean - 1)


def no_trend(steps: int) -> Criterion:
    """Return the criterion that the energy of an undamped pillar has no trend over these steps.

    Leapfrog conserves its discrete energy exactly, the composition of fourth order and the
    trapezoidal rule likewise an energy near it: what is recorded may swing, by what each sample
    shows, but not drift. Each step rounds velocities and displacements by half an eps, at random: a
    walk of sqrt(N) steps of eps at most, of which four standard deviations are allowed. A linear
    trend through n samples that swing by s is uncertain by sqrt(12 / n) s; four of these too.
    Implicit steps solve with factors of a matrix that is wrong by an eps, the same in every step:
    theirs may add up to eps a step.
    """

    @criterion(
        "linear trend of the energy, at most a random walk of round-off and the fit's own error"
    )
    def judge(trial: CaseTrial) -> Judgement:
        found = drift(trial, steps)
        x = found.steps / found.steps[-1]
        slope = np.polynomial.Polynomial.fit(x, found.energy, 1)
        swing = float(np.std(found.energy - slope(x)))
        trend = abs(float(slope(1.0) - slope(0.0)))
        walk = EPS * (steps if trial.is_implicit else 4 * sqrt(steps))
        bound = walk + 4 * sqrt(12 / len(x)) * swing
        return Judgement(trend, bound, f"of the energy over {steps:,} steps; swing {swing:.1e}")

    return judge


@criterion("decrease of dissipated energy, over the work")
def passive(trial: CaseTrial) -> Judgement:
    """Dissipated energy never returns, and energy is neither created nor lost.

    Of the second law: what sliding and opening have taken, and all that is spent (viscous,
    friction, fracture), fall by no more than round-off of the work put in. The viscous term alone
    may: where a joint slides, a dashpot whose spring unloads pushes the slide on, at the cost of
    friction. The boundary term is left out where springs hold the ends.
    """
    bound = ROUND_OFF * float(trial.result.attrs["steps"])
    return Judgement(largest_fall(trial.result), bound, "of the work")


ROUND_OFF = 1e-15
SPENT = ("viscous", "friction", "fracture")


def largest_fall(result: xr.Dataset) -> float:
    """Return the largest decrease of monotonic terms, over the largest work."""
    energy, terms = result["energy"].values, [str(t) for t in result["term"].values]
    work = float(np.abs(energy[terms.index("work")]).max())
    spent = {t: energy[terms.index(t)] for t in SPENT if t in terms}
    rows = [sum(spent.values()), *(row for t, row in spent.items() if t != "viscous")]
    falls = [float((np.maximum.accumulate(row) - row).max()) for row in rows if np.ndim(row)]
    return max(falls, default=0.0) / work if work else 0.0
