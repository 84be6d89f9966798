"""Every family of a scene on a grid of steps: the cheapest configuration that really does.

A point meets a misfit by its numerical and modelling error together, and where all finer points of
its family do.
"""

from collections.abc import Iterator
from math import inf, nan
from statistics import median

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import solve
from compare.experiments.common import FAILURES, reason_of
from compare.experiments.planner.families import Family, configured, effort, families_of
from compare.experiments.planner.planner import Plan, options_of, plan
from compare.experiments.planner.reference import OwnModel, References
from compare.experiments.planner.trials import (
    FINEST,
    Choice,
    Trial,
    furthest_off,
    is_hopeless,
    measured,
    steps,
    trial,
)

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
        for one in self._trials(family, own):
            first = first or one
            each = one.seconds / (work * one.per_sample / first.per_sample)
            rates[family.name] = min(rates.get(family.name, inf), each)
            self.points.append(measured(self.scene, family, one, own))

    def _trials(self, family: Family, own: OwnModel) -> Iterator[Trial]:
        """Yield runs of a family from the coarsest on, until no finer one can be of use; what meets
        all misfits is followed by one finer run."""
        first = last = trial(self.scene, family, own)
        yield first
        wanted = [m - own.least for m in self.misfits if m > own.least]
        for n in steps(first.per_sample, FINEST * first.per_sample, 2)[1:]:
            missed = [m for m in wanted if last.misfit > m]
            if last.seconds > min(LONGEST, self._dear([m + own.least for m in missed or wanted])):
                return
            before, last = last, trial(self.scene, family, own, first, n)
            yield last
            if all(is_hopeless([before, last], m) for m in missed):
                return

    def _dear(self, misfits: list[float]) -> float:
        """Return the seconds above which no run can be the cheapest for any of these misfits."""
        known = [best[0].seconds if (best := self.best(m)) else inf for m in misfits]
        return DEARER * max(known, default=-inf)


RIVALS = 4  # of the study: the cheapest by their own timing, which is noise for short runs
SHORT = 0.05  # s: the longest run that takes part in all rounds; three are enough above


def rows_of(scene: AnyScene, misfits: list[float], rounds: int) -> list[dict]:
    """Return a row for each misfit; a scene that cannot be planned has its reason."""
    try:
        references = References(scene, min(misfits))
    except FAILURES as error:
        return [_row(scene, m) | {"message": reason_of(error)} for m in misfits]
    study = Study(scene, references, misfits)
    return [_held(scene, study, m, rounds) for m in misfits]


def _held(scene: AnyScene, study: Study, misfit: float, rounds: int) -> dict:
    found, rivals = plan(scene, misfit), study.best(misfit)[:RIVALS]
    row = _row(scene, misfit) | _of_plan(found, misfit) | {"points": len(study.points)}
    seconds = _in_turns(scene, [c for c in (found.chosen, *rivals) if c is not None], rounds)
    if rivals:
        best = min(rivals, key=lambda c: seconds[_key(c)])
        row |= {
            "best": _text(best),
            "best_misfit": best.misfit,
            "best_seconds": seconds[_key(best)],
        }
    if found.chosen is not None:
        row["seconds"] = seconds[_key(found.chosen)]
    if rivals and found.chosen is not None:
        row["ratio"] = row["seconds"] / row["best_seconds"]
    return row


def _in_turns(scene: AnyScene, choices: list[Choice], rounds: int) -> dict[str, float]:
    """Return the median seconds of stepping of each configuration, all run in every round."""
    runs = {_key(c): (c.family.name, configured(scene, c.family, c.settings)) for c in choices}
    taken: dict[str, list[float]] = {key: [] for key in runs}
    for i in range(rounds + 1):
        for key, (name, asked) in runs.items():
            if len(taken[key]) < 3 or median(taken[key]) < SHORT:
                spent = float(solve(name, asked).attrs["seconds_stepping"])
                if i:  # the first is cold
                    taken[key].append(spent)
    return {key: median(spent) for key, spent in taken.items()}


def _key(choice: Choice) -> str:
    return " ".join(options_of(choice)) + choice.family.name


def _text(choice: Choice) -> str:
    (fraction,) = choice.settings.values()
    return f"{choice.family.label} {fraction:.3g}"


def _row(scene: AnyScene, misfit: float) -> dict:
    return {"variant": scene.name, "asked": misfit, "met": False, "ratio": nan, "message": ""}


def _of_plan(found: Plan, misfit: float) -> dict:
    about = {
        "reference": found.reference.name,
        "reference_error": found.reference.error,
        "trials": found.trials,
        "planning": found.planning,
        "met": found.misfit <= misfit,
    }
    if found.chosen is None:
        return about | {"chosen": "", "message": "nothing is predicted to meet it"}
    return about | {
        "chosen": _text(found.chosen),
        "modelling": found.chosen.modelling,
        "predicted_misfit": found.chosen.misfit,
        "misfit": found.misfit if found.misfit < inf else nan,
        "predicted_seconds": found.chosen.seconds,
        "obtained_seconds": found.seconds,
    }
