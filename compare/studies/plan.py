"""The cheapest way to solve a scene within a misfit: runs from cheap to dear until one meets it.

The criterion is the sum of two errors: the numerical one, of a run from its engine's own model, and
the modelling one, of that model from the finest physics. Errors that happen to cancel are therefore
no accuracy, and a run meets the misfit only if all runs of smaller steps do so, one at least.
"""

from contextlib import suppress
from dataclasses import dataclass, field
from math import ceil, inf
from time import perf_counter
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress
from jointwave.compare.misfit import ranking
from jointwave.compare.misfit.metrics import JUDGED, misfit
from jointwave.compare.studies.elements import (
    COARSEST,
    EXPLICIT,
    Elements,
    coarsest,
    configured,
    elements,
    halved,
    label,
    plain,
    rock,
)
from jointwave.compare.studies.reference import Reference, exact_reference
from jointwave.compare.studies.store import FAILURES, reason_of

LONGEST = {"pillar": 20.0, "rock mass": 60.0}  # s of stepping: no run is longer, unless asked for
FINE = 0.4  # of the critical step, at the coarsest, in a run that may become a reference
LEVELS = 10
#: Least growth in degrees of freedom of elements of half the size: 5 / 3 along a block of one
#: element of order 2, 25 / 9 in a quadrilateral. Blocks smaller than the elements do not grow.
GROWN = {"pillar": 1.5, "rock mass": 2.5}
MOST_HALVINGS = 4  # of elements at once, until there are more of them
STALLED = 0.8  # of the error before: smaller steps no longer help


class OwnModel(NamedTuple):
    """The model of an engine: the reference of its numerical errors, and its distance from the
    finest physics at most; infinite, with the reason, where no reference was found."""

    reference: Reference
    modelling: float
    reason: str


@dataclass
class PlannedRun:
    """A run: its engine, elements and step, its numerical and modelling error with those of their
    references, and its seconds of stepping.

    reference : of the numerical error. worst : the largest sum of errors of this run and of all
    smaller steps of its elements. is_confirmed : whether a smaller step was run.
    """

    elements: Elements
    reference: Reference
    numerical: float
    modelling: float
    seconds: float
    worst: float = 0.0
    is_confirmed: bool = False

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error, without regard to cancellation."""
        return self.numerical + self.modelling

    @property
    def options(self) -> list[str]:
        """The values of `--set` that make it."""
        table = ENGINES[self.elements.name].engine
        return [f"numerics.{table}.{k}={value}" for k, value in self.elements.numerics.items()]


@dataclass
class Plan:
    """The runs of a scene, from cheap to dear, and the choice among them.

    asked : the misfit. limit : s of stepping, None without. finest : the finest physics, and the
    reason for it. own : the engines' models by name. skipped : what could not or need not be run,
    with the reason. planning : s.
    """

    scene: AnyScene
    asked: float
    limit: float | None
    finest: Reference
    reason: str
    own: dict[str, OwnModel] = field(default_factory=dict)
    runs: list[PlannedRun] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)
    planning: float = 0.0

    @property
    def chosen(self) -> PlannedRun | None:
        """The cheapest run that meets the misfit, else the most accurate, of several the finest;
        within the limit. None without any."""
        runs = [run for run in self.runs if self.limit is None or run.seconds <= self.limit]
        meeting = [run for run in runs if self._is_met_by(run)]
        if meeting:
            return min(meeting, key=lambda run: run.seconds)
        return min(runs, key=lambda run: (run.worst, -run.elements.per_sample), default=None)

    @property
    def misfit(self) -> float:
        """Worst sum of numerical and modelling error of the chosen run; inf without one."""
        return inf if self.chosen is None else self.chosen.worst

    @property
    def is_met(self) -> bool:
        """Whether the chosen run meets the misfit."""
        return self.chosen is not None and self._is_met_by(self.chosen)

    def add(self, run: PlannedRun) -> list[PlannedRun]:
        """Add a run of smaller steps than those of its elements before, which are returned."""
        alike = [one for one in self.runs if one.elements.label == run.elements.label]
        for one in alike:
            one.worst, one.is_confirmed = max(one.worst, run.misfit), True
        run.worst = run.misfit
        self.runs.append(run)
        return alike

    def _is_met_by(self, run: PlannedRun) -> bool:
        return run.is_confirmed and run.worst <= self.asked


def plan(
    scene: AnyScene, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the runs made to find the cheapest one within a misfit, and the choice among them.

    seconds : limit of stepping, s: the best misfit within it if `misfit` costs more.
    Raises SceneError if there is no exact solution and no affordable run converges.
    """
    began = perf_counter()
    found = ranking.finest(_applicable(scene), scene)
    if found is None:
        raise SceneError(scene.where, "", None, "no solver resolves all physics of the scene")
    finest = _reference(scene, found.name, {}, misfit)
    made = Plan(scene, misfit, seconds, finest, found.reason)
    queue: list[Elements] = []
    for name, changes in coarsest(scene):
        try:
            queue.append(elements(scene, name, changes))
        except FAILURES as error:
            made.skipped[label(name, changes)] = reason_of(error)
    while queue:
        queue.sort(key=lambda one: one.seconds)
        one = queue.pop(0)
        if one.seconds > _affordable(made):
            break
        try:
            queue += _tried(made, one)
        except FAILURES as error:
            made.skipped[one.label] = reason_of(error)
        if progress:
            progress(1 - 0.9 ** len(made.runs))
    made.planning = perf_counter() - began
    return made


def _affordable(made: Plan) -> float:
    """Return the seconds above which a run is useless, or too long."""
    if made.chosen and made.is_met:
        return made.chosen.elements.seconds
    if made.limit is not None:
        return made.limit
    return LONGEST[made.scene.kind] - sum(run.seconds for run in made.runs)


def _tried(made: Plan, one: Elements) -> list[Elements]:
    """Run elements, and with half the step if they meet the misfit.

    Return what is to be tried next: half the step and, the first time, elements of half the size.
    """
    reference, modelling, reason = own_model(made, one)
    least = modelling + reference.error
    if modelling == inf or (least >= made.asked and made.limit is None):
        made.skipped[one.label] = reason
        return _finer(one) if one.model else []
    result = one.solve()
    numerical = misfit(result, reference.result) + reference.error
    seconds = float(result.attrs["seconds_stepping"])
    run = PlannedRun(one, reference, numerical, modelling, seconds)
    before = made.add(run)
    missed = [other for other in before if other.misfit > made.asked]
    half = one.with_steps(2 * one.per_sample)
    if run.misfit <= made.asked:
        return [] if before and before[-1].misfit <= made.asked else _tried(made, half)
    if missed and numerical > STALLED * missed[-1].numerical:
        return []
    return [half] if missed else [half, *_finer(one)]


def _finer(one: Elements) -> list[Elements]:
    """Return elements, or blocks, of half the size or less; none where their mesh is given or does
    not fit in memory."""
    changes = one.changes
    for _ in range(MOST_HALVINGS):
        if not (changes := halved(changes)):
            break
        with suppress(*FAILURES):
            finer = elements(one.scene, one.name, changes)
            if finer.run.freedoms >= GROWN[one.scene.kind] * one.run.freedoms:
                return [finer]
    return []


def own_model(made: Plan, one: Elements) -> OwnModel:
    """Return the model of elements, found once."""
    key = label(one.name, one.model)
    if key not in made.own:
        try:
            reference, modelling = _found_own(made, one)
            reason = f"the modelling error of {key} is already {100 * modelling:.3g} %"
            made.own[key] = OwnModel(reference, modelling, reason)
        except SceneError as error:
            made.own[key] = OwnModel(made.finest, inf, reason_of(error))
    return made.own[key]


def _found_own(made: Plan, one: Elements) -> tuple[Reference, float]:
    scene, finest = configured(made.scene, one.name, one.model), made.finest
    exact = ranking.own_exact(one.name, _applicable(scene), scene)
    block = getattr(made.scene.numerics.dem, "block", None)
    is_own = finest.name == one.name and one.model.get("block", block) == block
    if is_own or finest.name == exact:
        return finest, 0.0
    found = _reference(made.scene, exact or one.name, one.model, made.asked, finest.result)
    return found, misfit(found.result, finest.result) + finest.error


def _applicable(scene: AnyScene) -> list[str]:
    return [name for name, answer in ranking.applicable(scene).items() if answer]


def _reference(
    scene: AnyScene,
    name: str,
    model: dict[str, Any],
    asked: float,
    finest: xr.Dataset | None = None,
) -> Reference:
    """Return an exact solution, or a converged run of a model, each known to a tenth of a misfit.

    Raises SceneError if it is not.
    """
    if name in ENGINES:
        return _converged(scene, name, model, asked, finest)
    found = exact_reference(name, plain(scene))
    if JUDGED * found.error > asked:
        raise _not_known(scene, f"{name} knows itself", found.error, asked)
    return found


def _converged(
    scene: AnyScene, name: str, model: dict[str, Any], asked: float, finest: xr.Dataset | None
) -> Reference:
    """Return a model's run that differs little enough from the previous one.

    Each has at most half the step, and half the elements' size, of the previous one. Its error is
    at most the difference if the error falls at least in proportion to the step. A run also
    suffices once its model is certain to be further from the finest physics than requested.
    """
    rigid, apart, before = ENGINES[name].has_rigid_blocks, inf, None
    one = elements(scene, name, model if rigid else EXPLICIT | rock(scene, 2))
    one = one.with_steps(ceil(one.per_sample * COARSEST / FINE))
    for _ in range(LEVELS):
        if before is not None and one.seconds > LONGEST[scene.kind]:
            break
        result = one.solve()
        apart = inf if before is None else misfit(before, result)
        is_far = finest is not None and misfit(result, finest) - apart > asked
        if JUDGED * apart < asked or is_far:
            made = ", ".join(f"{k} {v}" for k, v in one.numerics.items())
            return Reference(name, result, apart, made)
        if not (finer := [one] if rigid else _finer(one)):
            break
        fewest = 0 if rigid else ceil(finer[0].per_sample * COARSEST / FINE)
        before, one = result, finer[0].with_steps(max(2 * one.per_sample, fewest))
    what = f"no exact solution to plan by, and {label(name, model)} within "
    what += f"{LONGEST[scene.kind]:g} s a run"
    if apart == inf:
        raise SceneError(scene.where, "", None, f"{what} has no finer elements to compare with")
    raise _not_known(scene, f"{what} converges", apart, asked)


def _not_known(scene: AnyScene, what: str, error: float, asked: float) -> SceneError:
    """Return the error for a reference that is not accurate enough."""
    share = f"to {100 * error:.2g} %, not to {100 * asked / JUDGED:.2g} %"
    return SceneError(scene.where, "", None, f"{what} {share}: ask for a larger --misfit")
