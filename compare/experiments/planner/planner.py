"""The cheapest way to solve a scene within a misfit: predicted from a few cheap runs, then run.

The criterion is the sum of two errors: the numerical one, of a configuration from its engine's own
model, and the modelling one, of that model from the finest physics. Errors that happen to cancel
are therefore not counted as accuracy.

Families of configurations are tried from coarse elements to fine ones, each from its coarsest step
on until finer steps can be predicted (see `trials`). A family is not tried if its freedom-steps
would cost more than a choice known to suffice, or if its modelling error is too large.
"""

from math import inf
from time import perf_counter
from typing import NamedTuple

from cases.errors import StoppedError
from cases.kinds import AnyScene
from compare.engines import Progress
from compare.experiments.common import ErrorReference
from compare.experiments.planner.families import (
    Effort,
    Family,
    configured,
    effort,
    families_of,
    is_finer,
)
from compare.experiments.planner.reference import OwnModel, References
from compare.experiments.planner.trials import (
    FINEST,
    LONGEST,
    MARGIN,
    Choice,
    Trial,
    cheapest,
    is_trusted,
    measured,
    predicted,
    timed,
    trial,
)
from compare.misfit.metrics import misfit as misfit_of
from compare.studies.store import FAILURES, reason_of

#: A family is not tried if it would be too expensive even at this fraction of the smallest time per
#: freedom-step measured so far.
SAFETY = 0.5
DEAR = "would cost more than a setting that meets the misfit"
SAME = "has the same blocks and elements as another family"


class Plan(NamedTuple):
    """The choice, and the result of running it.

    reference : the finest physics, and the reason for it. trials : runs made for predictions;
    planning : s, time of all planning, including references and compiling.
    chosen : None if no configuration is predicted to suffice. own : the numerical reference.
    obtained : the configuration as run; None without.
    skipped : families that could not or need not be run, with their reason.
    """

    scene: AnyScene
    reference: ErrorReference
    reason: str
    trials: int
    planning: float
    skipped: dict[str, str]
    chosen: Choice | None = None
    own: ErrorReference | None = None
    obtained: Choice | None = None

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error obtained; inf without a run."""
        return inf if self.obtained is None else self.obtained.misfit

    @property
    def seconds(self) -> float:
        """Seconds of stepping obtained; 0 without a run."""
        return 0.0 if self.obtained is None else self.obtained.seconds


class PlanSearch:
    """The trials of one scene so far, and the resulting choices."""

    def __init__(
        self, scene: AnyScene, references: References, misfit: float, seconds: float | None
    ) -> None:
        self.scene, self.references = scene, references
        self.misfit, self.seconds = misfit, seconds
        self.choices: list[Choice] = []
        self.dear: list[Family] = []
        self.sizes: set[tuple[object, ...]] = set()
        self.rates: dict[str, float] = {}
        self.trials = 0

    @property
    def limit(self) -> float:
        """Seconds above which a run is useless."""
        best = cheapest(self.choices, self.misfit, None)
        known = inf if best is None else best.seconds
        return known if self.seconds is None else min(known, self.seconds)

    def try_family(self, family: Family) -> None:
        """Run a family until it meets the misfit, is predicted, or costs too much."""
        if any(is_finer(family, other) for other in self.dear):
            raise StoppedError(DEAR)
        asked = effort(self.scene, family)
        # Of this engine if it has run.
        rate = self.rates.get(family.name, min(self.rates.values(), default=0.0))
        if SAFETY * rate * asked.work > self.limit:
            self.dear.append(family)
            raise StoppedError(DEAR)
        self._refuse_known(family, asked)
        own = self.references.own(family)
        if own.least >= self.misfit and self.seconds is None:
            raise StoppedError(own.too_far(family))
        trials = self._run(family, asked, own)
        self.choices += [measured(self.scene, family, one, own) for one in trials]
        if len(trials) > 1:
            self.choices += predicted(self.scene, family, trials, own)

    def _refuse_known(self, family: Family, asked: Effort) -> None:
        """Raise StoppedError if a coarser size gave the same number of parts."""
        order, scheme = (family.changes.get(key) for key in ("order", "scheme"))
        size = family.name, order, scheme, asked.freedoms
        if size in self.sizes:
            raise StoppedError(SAME)
        self.sizes.add(size)

    def _run(self, family: Family, asked: Effort, own: OwnModel) -> list[Trial]:
        trials = [trial(self.scene, family, own)]
        while not self._is_enough(family, trials, self.misfit - own.least):
            finer = 2 * trials[-1].per_sample
            trials.append(trial(self.scene, family, own, trials[0], finer))
        self.trials += len(trials)
        rates = [t.seconds / (asked.work * t.per_sample / asked.least) for t in trials]
        self.rates[family.name] = min(*rates, self.rates.get(family.name, inf))
        return trials

    def obtain(self, choice: Choice) -> Choice:
        """Return a choice with the result of a run."""
        family, own = choice.family, self.references.own(choice.family).reference
        asked = configured(self.scene, family, choice.settings)
        result, seconds = timed(family.name, asked)
        numerical = misfit_of(result, own.result) + own.error
        return choice._replace(numerical=numerical, seconds=seconds, measured=True)

    def _is_enough(self, family: Family, trials: list[Trial], asked: float) -> bool:
        """Return whether no finer trial is needed; asked : the largest numerical error.

        A trial that meets it must be confirmed by one of half its step.
        """
        last, meets = trials[-1], trials[-1].misfit <= asked
        if meets and len(trials) == 1:
            return False
        return (
            meets
            or last.seconds >= min(self.limit, LONGEST)
            or last.per_sample >= FINEST * trials[0].per_sample
            or is_trusted(trials, family.order, asked)
        )


def plan(
    scene: AnyScene, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the cheapest configuration predicted to meet a misfit, run.

    seconds : limit of stepping, s: the best misfit within it if `misfit` costs more.
    Raises SceneError if there is no exact solution and no affordable run converges.
    """
    began = perf_counter()
    references = References(scene, misfit)
    search = PlanSearch(scene, references, misfit, seconds)
    skipped = _tried(search, progress)
    chosen, obtained = _run_cheapest(search)
    own = None if chosen is None else references.own(chosen.family).reference
    about = references.finest, references.reason, search.trials, perf_counter() - began, skipped
    return Plan(scene, *about, chosen, own, obtained)


def _run_cheapest(search: PlanSearch) -> tuple[Choice | None, Choice | None]:
    """Return the cheapest choice and its result; a result that differs from its prediction counts
    as a trial, and the next choice is run."""
    chosen = obtained = None
    while (best := cheapest(search.choices, search.misfit, search.seconds)) is not None:
        chosen, obtained = best, search.obtain(best)
        if best.measured or obtained.misfit <= max(search.misfit, best.misfit / MARGIN):
            break
        search.trials += 1
        search.choices = [c for c in search.choices if c is not best] + [obtained]
    return chosen, obtained


def _tried(search: PlanSearch, progress: Progress | None) -> dict[str, str]:
    skipped = {}
    families = families_of(search.scene)
    for i, family in enumerate(families):
        try:
            search.try_family(family)
        except FAILURES as error:
            skipped[family.label] = reason_of(error)
        if progress:
            progress((i + 1) / (len(families) + 1))
    return skipped


def options_of(choice: Choice) -> list[str]:
    """Return the `--set` options that make a configuration."""
    found = {**choice.family.changes, **choice.settings}
    return [f"numerics.{choice.family.engine}.{key}={value}" for key, value in found.items()]
