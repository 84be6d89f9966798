"""Trial runs of a family, predictions for finer steps, and the choice among both.

The error of a family falls with some order q, so that each of its waveforms at n steps per sample
is w + c n^-q (Richardson): from two runs its misfit from the engine's own model is known for every
n. From three, so is q: half the steps leave 2^q times the difference. Seconds are a + b n.
"""

from collections.abc import Callable, Iterator
from math import ceil, inf, log2
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from cases.kinds import AnyScene
from compare.engines import solve, stepping
from compare.experiments.planner.families import COARSEST, Family, configured, settings
from compare.experiments.planner.reference import OwnModel
from compare.misfit.metrics import Stack, stacked

SHORT = 0.05  # s: shorter runs are timed three more times, because of noise
SLOWEST = 0.5  # lowest order of convergence, reached at repeated kinks
FINEST = 64  # times the steps of the coarsest
LONGEST = 1.0  # s: a longer trial is the last of its family
HIT = 0.1  # of the misfit: tolerated difference of a trial from its prediction

#: What is only predicted must be below this part of the misfit: two steps leave the next term of
#: the error.
MARGIN = 0.95


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
        again = stepping(name, scene)
        seconds = min(seconds, *(again() for _ in range(3)))
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


class Choice(NamedTuple):
    """One configuration with its errors and cost, measured or predicted.

    numerical : relative L2 misfit from the engine's own model, plus that reference's uncertainty.
    modelling : of the own model from the finest physics. seconds : of stepping.
    """

    family: Family
    settings: dict[str, Any]
    per_sample: int
    numerical: float
    modelling: float
    seconds: float
    measured: bool = False

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error, without regard to cancellation."""
        return self.numerical + self.modelling


def measured(scene: AnyScene, family: Family, trial: Trial, own: OwnModel) -> Choice:
    """Return the configuration of a trial, with its result."""
    numerics = settings(scene, family, trial.per_sample, trial.critical)
    errors = trial.misfit + own.reference.error, own.modelling
    return Choice(family, numerics, trial.per_sample, *errors, trial.seconds, True)


def predicted(
    scene: AnyScene, family: Family, trials: list[Trial], own: OwnModel
) -> Iterator[Choice]:
    """Yield the configurations of a family from the last trial but one on, as predicted."""
    coarse, fine = trials[-2:]
    told, (start, each) = forecast(trials, family.order), seconds_of(coarse, fine)
    for n in steps(coarse.per_sample, trials[0].per_sample * FINEST, 4):
        numerics = settings(scene, family, n, fine.critical)
        numerical = largest(fine.waves.distances(told(n), fine.waves.other))
        errors = numerical + own.reference.error, own.modelling
        yield Choice(family, numerics, n, *errors, start + each * n)


def seconds_of(coarse: Trial, fine: Trial) -> tuple[float, float]:
    """Return (a, b) of seconds a + b n, both at least 0, that give the finer trial's."""
    each = (fine.seconds - coarse.seconds) / (fine.per_sample - coarse.per_sample)
    each = min(max(each, 0.0), fine.seconds / fine.per_sample)
    return fine.seconds - each * fine.per_sample, each


def steps(least: int, most: int, per_octave: int) -> list[int]:
    """Return steps per sample from `least` on, `per_octave` per doubling."""
    octaves = ceil(per_octave * log2(most / least))
    return sorted({ceil(least * 2 ** (k / per_octave) - 1e-9) for k in range(octaves + 1)})


def cheapest(choices: list[Choice], misfit: float, seconds: float | None) -> Choice | None:
    """Return the cheapest that meets the misfit; else, or if it costs more, the best in time.

    A choice meets it if all known or predicted finer steps of its family do.
    """
    meets = [c for c in choices if _meets(c, misfit) and furthest_off(c, choices) <= misfit]
    best = min(meets, key=lambda c: c.seconds, default=None)
    if seconds is None or (best is not None and best.seconds <= seconds):
        return best
    in_time = [c for c in choices if c.seconds <= seconds]
    return min(in_time, key=lambda c: furthest_off(c, choices), default=None)


def _meets(choice: Choice, misfit: float) -> bool:
    margin = 1.0 if choice.measured else MARGIN
    return choice.numerical <= margin * (misfit - choice.modelling)


def furthest_off(choice: Choice, choices: list[Choice]) -> float:
    """Return the largest misfit of a choice and of the finer steps of its family."""
    return max(
        c.misfit for c in choices if c.family == choice.family and c.per_sample >= choice.per_sample
    )
