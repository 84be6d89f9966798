"""Trial runs of a family, and what they say of finer steps.

The error of a family falls with some order q, so that its waveforms at n steps per sample are
w + c n^-q (Richardson): from two runs their misfit from the reference is known for every n. From
three, so is q: half the steps leave 2^q times the difference. Seconds are a + b n.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil, inf, log2
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from cases.scene import Scene
from compare.engines import solve
from compare.metrics import recorded, relative_l2
from compare.plan_families import COARSEST, Family, configured, settings

SHORT = 0.05  # s: a shorter run is timed three times more, as it is noise alone
SLOWEST = 0.5  # order at which errors fall, at least: they do at kinks that repeat
FINEST = 64  # times the steps of the coarsest
LONGEST = 1.0  # s: a trial that takes as long is the last of its family
HIT = 0.1  # of the misfit, that a trial may be from where those before it put it


class Trial(NamedTuple):
    """A run at so many steps per sample: its waveforms and the reference's, the s of stepping."""

    per_sample: int
    wave: np.ndarray
    goal: np.ndarray
    seconds: float
    critical: float

    @property
    def misfit(self) -> float:
        """Relative L2 from the reference."""
        return relative_l2(self.wave, self.goal)


class Choice(NamedTuple):
    """One configuration and what it gives: relative L2 misfit, s of stepping; measured or not."""

    family: Family
    settings: dict[str, Any]
    misfit: float
    seconds: float
    measured: bool = False


def timed(name: str, scene: Scene) -> tuple[xr.Dataset, float]:
    """Return a result and its seconds of stepping: the least of four runs where it is short, which
    other work on the machine delays least."""
    result = solve(name, scene)
    seconds = float(result.attrs["seconds_stepping"])
    if seconds < SHORT:
        more = (float(solve(name, scene).attrs["seconds_stepping"]) for _ in range(3))
        seconds = min(seconds, *more)
    return result, seconds


def first_trial(scene: Scene, family: Family, reference: xr.Dataset) -> Trial:
    """Run a family at the coarsest of its steps."""
    start = {} if family.is_implicit else {"step_fraction": COARSEST}
    if family.is_implicit:
        start = settings(scene, family, 1, scene.interval)
    return _trial(scene, family, start, reference)


def trial_at(
    scene: Scene, family: Family, per_sample: int, first: Trial, reference: xr.Dataset
) -> Trial:
    """Run a family at so many steps per sample, after its first trial."""
    return _trial(scene, family, settings(scene, family, per_sample, first.critical), reference)


def _trial(scene: Scene, family: Family, numerics: dict[str, Any], reference: xr.Dataset) -> Trial:
    result, seconds = timed(family.name, configured(scene, family, numerics))
    wave, goal = recorded(result, reference)
    per_sample = round(scene.interval / float(result.attrs["dt"]))
    return Trial(per_sample, wave, goal, seconds, float(result.attrs["critical_dt"]))


def is_trusted(trials: list[Trial], order: int, asked: float) -> bool:
    """Return whether finer steps can be told from these, or none comes within the misfit.

    They can where the last trial is where those before it put it, to a part of the misfit that is
    asked for or, if that is more, of what the model leaves at the finest steps.
    """
    if len(trials) < 2:
        return False
    if is_hopeless(trials, asked):
        return True
    if len(trials) < 3:
        return False
    last = trials[-1]
    told, limit = forecast(trials[:-1], order)(last.per_sample), forecast(trials, order)(inf)
    off = float(np.linalg.norm(told - last.wave) / np.linalg.norm(last.goal))
    return off < HIT * max(asked, relative_l2(limit, last.goal))


def is_hopeless(trials: list[Trial], asked: float) -> bool:
    """Return whether no step comes within the misfit, even if the error falls at the slowest."""
    coarse, fine = trials[-2:]
    left = relative_l2(coarse.wave, fine.wave) / (
        (fine.per_sample / coarse.per_sample) ** SLOWEST - 1
    )
    reach = left * float(np.linalg.norm(fine.wave) / np.linalg.norm(fine.goal))
    return fine.misfit - reach > asked


def rate(trials: list[Trial], order: int) -> float:
    """Return the order at which the error falls: measured from three runs, else its scheme's."""
    if len(trials) < 3:
        return float(order)
    a, b, c = (trial.wave for trial in trials[-3:])
    before, after = np.linalg.norm(a - b), np.linalg.norm(b - c)
    if not before or not after:
        return float(order)
    return float(np.clip(log2(before / after), SLOWEST, order))


def measured(scene: Scene, family: Family, trial: Trial) -> Choice:
    """Return the configuration of a trial, with what it gave."""
    numerics = settings(scene, family, trial.per_sample, trial.critical)
    return Choice(family, numerics, trial.misfit, trial.seconds, True)


def forecast(trials: list[Trial], order: int) -> Callable[[float], np.ndarray]:
    """Return a function from steps per sample to waveforms, w + c n^-q through the last trials."""
    coarse, fine = trials[-2:]
    q = rate(trials, order)
    part = (coarse.wave - fine.wave) / ((fine.per_sample / coarse.per_sample) ** q - 1)
    return lambda n: fine.wave - part * (1 - (fine.per_sample / n) ** q)


def predicted(scene: Scene, family: Family, trials: list[Trial]) -> Iterator[Choice]:
    """Yield the configurations of a family from the last trial but one on, as predicted."""
    coarse, fine = trials[-2:]
    told, (start, each) = forecast(trials, family.order), seconds_of(coarse, fine)
    for n in steps(coarse.per_sample, trials[0].per_sample * FINEST, 4):
        numerics = settings(scene, family, n, fine.critical)
        misfit = relative_l2(told(n), fine.goal)
        yield Choice(family, numerics, misfit, start + each * n)


def seconds_of(coarse: Trial, fine: Trial) -> tuple[float, float]:
    """Return (a, b) of seconds a + b n, both at least 0, that give the finer trial's."""
    each = (fine.seconds - coarse.seconds) / (fine.per_sample - coarse.per_sample)
    each = min(max(each, 0.0), fine.seconds / fine.per_sample)
    return fine.seconds - each * fine.per_sample, each


def steps(least: int, most: int, per_octave: int) -> list[int]:
    """Return steps per sample from `least` on, so many to a doubling."""
    octaves = ceil(per_octave * log2(most / least))
    return list(
        dict.fromkeys(ceil(least * 2 ** (k / per_octave) - 1e-9) for k in range(octaves + 1))
    )
