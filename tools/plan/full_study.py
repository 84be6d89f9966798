"""Every family of a scene on a grid of steps: the cheapest configuration that really does.

A point meets a misfit by its numerical and modelling error together, and where all finer points of
its family do.
"""

from collections.abc import Iterator
from math import inf

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.experiments.common import FAILURES, reason_of
from compare.experiments.planner.choices import Choice, furthest_off, measured, steps
from compare.experiments.planner.families import Family, effort, families_of
from compare.experiments.planner.reference import OwnModel, References
from compare.experiments.planner.trials import FINEST, Trial, first_trial, is_hopeless, trial_at

#: A family ends where a run takes so many times the seconds of the cheapest that does, as finer
#: steps cost more. It is not begun where it would even at half the seconds that a freedom-step has
#: taken at least.
DEARER = 3.0
LONGEST = 2.0  # s: a run that takes as long is the last of its family


class Study:
    """All points of a scene, and why the families that are not among them are not."""

    def __init__(self, scene: AnyScene, references: References, misfits: list[float]) -> None:
        """Run every family at two steps to a doubling until it meets all misfits or cannot win."""
        self.scene, self.references, self.misfits = scene, references, misfits
        self.points: list[Choice] = []
        self.skipped: dict[str, str] = {}
        self._rates: dict[str, float] = {}
        for family in families_of(scene):
            try:
                self._add(family)
            except FAILURES as error:
                self.skipped[family.label] = reason_of(error)

    def best(self, misfit: float) -> list[Choice]:
        """Return the points that meet a misfit, the cheapest first."""
        meets = (p for p in self.points if furthest_off(p, self.points) <= misfit)
        return sorted(meets, key=lambda p: p.seconds)

    def _add(self, family: Family) -> None:
        work, rates = effort(self.scene, family).work, self._rates
        rate = rates.get(family.name, min(rates.values(), default=0.0))
        if 0.5 * rate * work > self._dear(self.misfits):
            raise SceneError(self.scene.where, "", None, f"over {DEARER:g} times the cheapest")
        first, own = None, self.references.own(family)
        if own.least >= max(self.misfits):
            raise SceneError(self.scene.where, "", None, own.too_far(family))
        for trial in self._trials(family, own):
            first = first or trial
            each = trial.seconds / (work * trial.per_sample / first.per_sample)
            rates[family.name] = min(rates.get(family.name, inf), each)
            self.points.append(measured(self.scene, family, trial, own))

    def _trials(self, family: Family, own: OwnModel) -> Iterator[Trial]:
        """Yield runs of a family from the coarsest on, until no finer one can be of use; what meets
        all misfits is followed by one finer run."""
        first = last = first_trial(self.scene, family, own)
        yield first
        wanted = [m - own.least for m in self.misfits if m > own.least]
        for n in steps(first.per_sample, FINEST * first.per_sample, 2)[1:]:
            missed = [m for m in wanted if last.misfit > m]
            if last.seconds > min(LONGEST, self._dear([m + own.least for m in missed or wanted])):
                return
            before, last = last, trial_at(self.scene, family, n, first, own)
            yield last
            if all(is_hopeless([before, last], m) for m in missed):
                return

    def _dear(self, misfits: list[float]) -> float:
        """Return the seconds above which no run can be the cheapest for any of these misfits."""
        known = [best[0].seconds if (best := self.best(m)) else inf for m in misfits]
        return DEARER * max(known, default=-inf)
