"""Trial runs of a family, and predictions for finer steps.

The error of a family falls with some order q, so that each of its waveforms at n steps per sample
is w + c n^-q (Richardson): from two runs its misfit from the engine's own model is known for every
n. From three, so is q: half the steps leave 2^q times the difference. Seconds are a + b n.
"""

from collections.abc import Callable
from math import inf
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from cases.kinds import AnyScene
from compare.engines import solve
from compare.experiments.planner.families import COARSEST, Family, configured, settings
from compare.experiments.planner.reference import OwnModel
from compare.misfit.metrics import Stack, stacked

SHORT = 0.05  # s: shorter runs are timed three more times, because of noise
SLOWEST = 0.5  # lowest order of convergence, reached at repeated kinks
FINEST = 64  # times the steps of the coarsest
LONGEST = 1.0  # s: a longer trial is the last of its family
HIT = 0.1  # of the misfit: tolerated difference of a trial from its prediction


class Trial(NamedTuple):
    """A run at `per_sample` steps per sample: its waveforms with those of the engine's own model,
    the seconds of stepping, and the critical step (s)."""

    per_sample: int
    waves: Stack
    seconds: float
    critical: float

    @property
    def misfits(self) -> np.ndarray:
        """Relative L2 from the engine's own model, of each waveform."""
        return self.waves.misfits

    @property
    def misfit(self) -> float:
        """That of the worst waveform: the numerical error."""
        return largest(self.misfits)


def timed(name: str, scene: AnyScene) -> tuple[xr.Dataset, float]:
    """Return a result and its seconds of stepping: for a short run the minimum of four, which is
    the least affected by other load."""
    result = solve(name, scene)
    seconds = float(result.attrs["seconds_stepping"])
    if seconds < SHORT:
        more = (float(solve(name, scene).attrs["seconds_stepping"]) for _ in range(3))
        seconds = min(seconds, *more)
    return result, seconds


def trial(
    scene: AnyScene, family: Family, own: OwnModel, first: Trial | None = None, per_sample: int = 0
) -> Trial:
    """Run a family at `per_sample` steps per sample, after its first trial, itself the coarsest."""
    numerics: dict[str, Any] = {"step_fraction": COARSEST}
    if first is not None:
        numerics = settings(scene, family, per_sample, first.critical)
    elif family.is_implicit:
        numerics = settings(scene, family, 1, scene.interval)
    result, seconds = timed(family.name, configured(scene, family, numerics))
    per_sample = round(scene.interval / float(result.attrs["dt"]))
    waves = stacked(result, own.reference.result)
    return Trial(per_sample, waves, seconds, float(result.attrs["critical_dt"]))


def is_trusted(trials: list[Trial], order: int, asked: float) -> bool:
    """Return whether finer steps can be predicted from these trials, or none meets the misfit.

    They can if the last trial agrees with its prediction, to a part of the requested numerical
    error or, if larger, of the elements' error at the finest steps.
    """
    if len(trials) < 2:
        return False
    if is_hopeless(trials, asked):
        return True
    if len(trials) < 3:
        return False
    last = trials[-1].waves
    told, limit = forecast(trials[:-1], order)(trials[-1].per_sample), forecast(trials, order)(inf)
    off, left = last.distances(told, last.one), last.distances(limit, last.other)
    return largest(off) < HIT * max(asked, largest(left))


def is_hopeless(trials: list[Trial], asked: float) -> bool:
    """Return whether no step meets the requested numerical error, even at the slowest rate of
    convergence."""
    coarse, fine = trials[-2:]
    moved = fine.waves.distances(coarse.waves.one, fine.waves.one)
    reach = moved / ((fine.per_sample / coarse.per_sample) ** SLOWEST - 1)
    return bool(np.any(fine.misfits - reach > asked))


def rate(trials: list[Trial], order: int) -> np.ndarray:
    """Return the order of convergence of each waveform, [waveform, 1]: measured from three runs,
    else the scheme's."""
    if len(trials) < 3:
        return np.full((len(trials[0].waves.one), 1), float(order))
    a, b, c = (trial.waves.one for trial in trials[-3:])
    before, after = (np.linalg.norm(x, axis=1, keepdims=True) for x in (a - b, b - c))
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.clip(np.log2(before / after), SLOWEST, order)
    return np.where((before > 0) & (after > 0), found, order)


def forecast(trials: list[Trial], order: int) -> Callable[[float], np.ndarray]:
    """Return a function from steps per sample to waveforms, w + c n^-q through the last trials."""
    coarse, fine = trials[-2:]
    q, wave = rate(trials, order), fine.waves.one
    part = (coarse.waves.one - wave) / ((fine.per_sample / coarse.per_sample) ** q - 1)
    return lambda n: wave - part * (1 - (fine.per_sample / n) ** q)


def largest(distances: np.ndarray) -> float:
    """Return the largest of distances [waveform], 0 without any."""
    return float(np.max(distances, initial=0.0))
