"""The cheapest way to solve a scene within a misfit: predicted from a few cheap runs, then run.

Families of configurations are tried from coarse elements to fine ones, each from its coarsest step
on until finer steps can be predicted (see `plan_trials`). What by its freedom-steps would cost more
than what is known to meet the misfit is not tried at all.
"""

from __future__ import annotations

from math import inf
from time import perf_counter
from typing import NamedTuple

from cases.errors import SceneError, StoppedError, UnstableError
from cases.scene import Scene
from compare.engines import Progress
from compare.metrics import recorded, relative_l2
from compare.plan_families import FAMILIES, Effort, Family, configured, effort, is_finer
from compare.plan_reference import Reference, reference_of
from compare.plan_trials import (
    FINEST,
    LONGEST,
    Choice,
    Trial,
    first_trial,
    is_trusted,
    measured,
    predicted,
    timed,
    trial_at,
)

#: A family is not tried where it would be too dear at this share of the least seconds that a
#: freedom-step has taken so far.
SAFETY = 0.5
#: What is only predicted must be below this part of the misfit: two steps leave the next term of
#: the error.
MARGIN = 0.95
DEAR = "would cost more than what is known to do"
FAILURES = (SceneError, UnstableError, StoppedError)


class Plan(NamedTuple):
    """What was chosen, and what came of it.

    reference : what the misfit is from. trials : runs that were made to predict; planning : s that
    all of the planning took, the reference and compiling included.
    chosen : None where nothing is predicted to do. misfit, seconds : obtained; inf and 0 without.
    skipped : families that could not or need not be run, with their reason.
    """

    scene: Scene
    reference: Reference
    trials: int
    planning: float
    chosen: Choice | None
    misfit: float
    seconds: float
    skipped: dict[str, str]


class Search:
    """Trials so far of one scene, and the choices that they leave."""

    def __init__(
        self, scene: Scene, reference: Reference, misfit: float, seconds: float | None
    ) -> None:
        self.scene, self.reference = scene, reference
        self.misfit, self.seconds = misfit, seconds
        self.choices: list[Choice] = []
        self.dear: list[Family] = []
        self.rates: dict[str, float] = {}
        self.trials = 0

    @property
    def limit(self) -> float:
        """Seconds from which a run is of no use."""
        best = cheapest(self.choices, self.misfit, None)
        known = inf if best is None else best.seconds
        return known if self.seconds is None else min(known, self.seconds)

    def try_family(self, family: Family) -> None:
        """Run a family until it meets the misfit, is predicted, or costs too much."""
        if any(is_finer(family, other) for other in self.dear):
            raise SceneError(self.scene.where, "", None, DEAR)
        asked = effort(self.scene, family)
        if SAFETY * self._rate(family) * asked.work > self.limit:
            self.dear.append(family)
            raise SceneError(self.scene.where, "", None, DEAR)
        trials = self._run(family, asked)
        self.choices += [measured(self.scene, family, trial) for trial in trials]
        if len(trials) > 1:
            self.choices += predicted(self.scene, family, trials)

    def _run(self, family: Family, asked: Effort) -> list[Trial]:
        trials = [first_trial(self.scene, family, self.reference.result)]
        while not self._is_enough(family, trials):
            finer = 2 * trials[-1].per_sample
            trials.append(trial_at(self.scene, family, finer, trials[0], self.reference.result))
        self.trials += len(trials)
        rates = [t.seconds / (asked.work * t.per_sample / asked.least) for t in trials]
        self.rates[family.name] = min(*rates, self.rates.get(family.name, inf))
        return trials

    def _rate(self, family: Family) -> float:
        """Return the least seconds of a freedom-step so far, of this engine where it has run."""
        return self.rates.get(family.name, min(self.rates.values(), default=0.0))

    def _is_enough(self, family: Family, trials: list[Trial]) -> bool:
        last = trials[-1]
        return (
            last.misfit <= self.misfit
            or last.seconds >= min(self.limit, LONGEST)
            or last.per_sample >= FINEST * trials[0].per_sample
            or is_trusted(trials, family.order, self.misfit)
        )


def plan(
    scene: Scene, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the cheapest configuration predicted to meet a misfit, run.

    seconds : instead the best misfit within so many s of stepping, where `misfit` costs more.
    Raises SceneError where nothing exact is known of the scene, and no run converges in reach.
    """
    began = perf_counter()
    reference = reference_of(scene, misfit)
    search = Search(scene, reference, misfit, seconds)
    skipped = _tried(search, progress)
    chosen, spent = cheapest(search.choices, misfit, seconds), perf_counter() - began
    about = scene, reference, search.trials, spent
    if chosen is None:
        return Plan(*about, None, inf, 0.0, skipped)
    result, took = timed(chosen.family.name, configured(scene, chosen.family, chosen.settings))
    obtained = relative_l2(*recorded(result, reference.result))
    return Plan(*about, chosen, obtained, took, skipped)


def _tried(search: Search, progress: Progress | None) -> dict[str, str]:
    """Try all families; return the reasons of those that were not run."""
    skipped = {}
    for i, family in enumerate(FAMILIES):
        try:
            search.try_family(family)
        except FAILURES as error:
            skipped[family.label] = reason_of(error)
        if progress:
            progress((i + 1) / (len(FAMILIES) + 1))
    return skipped


def reason_of(error: Exception) -> str:
    """Return why something could not be run, without where."""
    return getattr(error, "allowed", str(error))


def cheapest(choices: list[Choice], misfit: float, seconds: float | None) -> Choice | None:
    """Return the cheapest that meets the misfit; else, or where it costs more, the best in time."""
    meets = [c for c in choices if c.misfit <= (misfit if c.measured else MARGIN * misfit)]
    best = min(meets, key=lambda c: c.seconds, default=None)
    if seconds is None or (best is not None and best.seconds <= seconds):
        return best
    in_time = [c for c in choices if c.seconds <= seconds]
    return min(in_time, key=lambda c: c.misfit, default=None)


def options_of(choice: Choice) -> list[str]:
    """Return the `--set` options that make a configuration."""
    found = {**choice.family.changes, **choice.settings}
    return [f"numerics.{choice.family.engine}.{key}={value}" for key, value in found.items()]
