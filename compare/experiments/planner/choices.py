"""Choices: configurations with their errors and cost, measured by a trial or predicted."""

from collections.abc import Iterator
from math import ceil, log2
from typing import Any, NamedTuple

from cases.kinds import AnyScene
from compare.experiments.planner.families import Family, settings
from compare.experiments.planner.reference import OwnModel
from compare.experiments.planner.trials import FINEST, Trial, forecast, largest

#: What is only predicted must be below this part of the misfit: two steps leave the next term of
#: the error.
MARGIN = 0.95


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
