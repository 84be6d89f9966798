"""The cheapest way to solve a scene within a misfit: try runs in order of cost until one meets it.

The criterion is the sum of the numerical error (run against its engine's own model) and the
modelling error (that model against the finest physics), so that errors cannot cancel. A run meets
the misfit if at least one run with smaller steps was made, and all of these meet it too.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from numbers import Real
from time import perf_counter
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress
from jointwave.compare.misfit import ranking
from jointwave.compare.misfit.metrics import JUDGED, misfit
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.studies import elements as choices
from jointwave.compare.studies.elements import Elements, configured, elements, label, plain
from jointwave.compare.studies.measure import Reference, able, exact_reference
from jointwave.compare.studies.store import FAILURES, reason_of

LONGEST = {"pillar": 20.0, "rock mass": 60.0}  # s of stepping, the limit if none is given
MOST = 0.5  # largest misfit to plan for; nearly every run is within more
STALLED = 0.8  # least ratio to the previous error at which smaller steps no longer help


class PlannedRun(NamedTuple):
    """A run: its elements and step, its numerical and modelling error, each including the error of
    its reference, and its seconds of stepping.

    reference : of the numerical error.
    """

    elements: Elements
    reference: Reference
    numerical: float
    modelling: float
    seconds: float

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error, an upper bound."""
        return self.numerical + self.modelling

    @property
    def options(self) -> list[str]:
        """The values of `--set` that reproduce the run."""
        table = ENGINES[self.elements.name].engine
        return [f"numerics.{table}.{k}={value}" for k, value in self.elements.numerics.items()]


@dataclass
class Plan:
    """The runs of a scene, in order of cost, and the choice among them.

    asked : the requested misfit. limit : s of stepping, None if not limited. finest : the finest
    physics; reason : why it is the finest. own : results of `own_model`. skipped : reason for each
    run that was not made. planning : s.
    """

    scene: AnyScene
    asked: float
    limit: float | None
    finest: Reference = field(repr=False)
    reason: str
    own: dict[str, tuple[Reference, float] | SceneError] = field(default_factory=dict, repr=False)
    runs: list[PlannedRun] = field(default_factory=list, repr=False)
    skipped: dict[str, str] = field(default_factory=dict)
    planning: float = 0.0

    @property
    def chosen(self) -> PlannedRun | None:
        """The cheapest run within the limit that meets the misfit, else the most accurate one (of
        equals the finest); None if there is no run."""
        runs = [run for run in self.runs if self.limit is None or run.seconds <= self.limit]
        if meeting := [run for run in runs if self._is_met_by(run)]:
            return min(meeting, key=lambda run: run.seconds)
        return min(runs, key=lambda run: (self.worst(run), -run.elements.per_sample), default=None)

    @property
    def misfit(self) -> float:
        """Sum of errors of the chosen run, see `worst`; inf if there is none."""
        return inf if self.chosen is None else self.worst(self.chosen)

    @property
    def is_met(self) -> bool:
        """Whether the chosen run meets the misfit."""
        return self.chosen is not None and self._is_met_by(self.chosen)

    @property
    def affordable(self) -> float:
        """The expected seconds above which another run is useless or too long."""
        if self.chosen and self.is_met:
            return self.chosen.elements.seconds
        if self.limit is not None:
            return self.limit
        return LONGEST[self.scene.kind] - sum(run.seconds for run in self.runs)

    def worst(self, run: PlannedRun) -> float:
        """Return the largest sum of errors of a run and of its elements' smaller steps."""
        return max(one.misfit for one in [run, *self._finer(run)])

    def _is_met_by(self, run: PlannedRun) -> bool:
        return bool(self._finer(run)) and self.worst(run) <= self.asked

    def _finer(self, run: PlannedRun) -> list[PlannedRun]:
        own, steps = run.elements.label, run.elements.per_sample
        alike = [one for one in self.runs if one.elements.label == own]
        return [one for one in alike if one.elements.per_sample > steps]


def plan(
    scene: AnySource, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the runs made to find the cheapest one within a misfit, and the choice among them.

    seconds : limit of stepping, s; if the misfit costs more, the best run within it is chosen.
    Raises SceneError if there is no exact solution and no affordable run converges.
    """
    began, scene = perf_counter(), load(scene)
    if not (isinstance(misfit, Real) and 0 < misfit <= MOST):
        allowed = f"must be a positive number of at most {MOST}, as 0.02"
        raise SceneError("plan", "misfit", misfit, allowed)
    found = ranking.finest(able(scene), scene)
    if found is None:
        raise SceneError(scene.where, "", None, "no solver resolves all physics of the scene")
    made = Plan(scene, misfit, seconds, _reference(scene, found.name, {}, misfit), found.reason)
    queue: list[Elements] = []
    for name, changes in choices.coarsest(scene):
        try:
            queue.append(elements(scene, name, changes))
        except FAILURES as error:
            made.skipped[label(name, changes)] = reason_of(error)
    while queue:
        queue.sort(key=lambda one: one.seconds)
        one = queue.pop(0)
        if one.seconds > made.affordable:
            break
        try:
            queue += _tried(made, one)
        except FAILURES as error:
            made.skipped[one.label] = reason_of(error)
            queue += one.finer() if one.model else []  # smaller blocks are another model
        if progress:
            progress(1 - 0.9 ** len(made.runs))
    made.planning = perf_counter() - began
    return made


def _tried(made: Plan, one: Elements) -> list[Elements]:
    """Run elements; if they meet the misfit, confirm it with half the step.

    Return what to try next: on the first run of these elements finer ones, and half the step unless
    confirmed or stalled. Raises SceneError if their model cannot meet the misfit.
    """
    reference, modelling = own_model(made, one)
    if modelling + reference.error >= made.asked and made.limit is None:
        far = f"the modelling error of {label(one.name, one.model)} is already"
        raise SceneError(made.scene.where, "", None, f"{far} {100 * modelling:.3g} %")
    result = one.solve()
    numerical = misfit(result, reference.result) + reference.error
    seconds = float(result.attrs["seconds_stepping"])
    run = PlannedRun(one, reference, numerical, modelling, seconds)
    before = [other for other in made.runs if other.elements.label == one.label]
    made.runs.append(run)
    smaller, half = [] if before else one.finer(), one._replace(per_sample=2 * one.per_sample)
    if run.misfit <= made.asked:
        is_confirmed = before and before[-1].misfit <= made.asked
        return smaller + ([] if is_confirmed else _tried(made, half))
    is_stalled = before and numerical > STALLED * before[-1].numerical
    return smaller + ([] if is_stalled else [half])


def own_model(made: Plan, one: Elements) -> tuple[Reference, float]:
    """Return the reference for numerical errors of elements, and an upper bound of their modelling
    error; computed once per model. Raises SceneError if there is no reference."""
    key = label(one.name, one.model)
    if key not in made.own:
        try:
            made.own[key] = _found_own(made, one)
        except SceneError as error:
            made.own[key] = error
    if isinstance(found := made.own[key], SceneError):
        raise found
    return found


def _found_own(made: Plan, one: Elements) -> tuple[Reference, float]:
    scene, finest = configured(made.scene, one.name, one.model), made.finest
    exact = ranking.own_exact(one.name, able(scene), scene)
    block = getattr(made.scene.numerics.dem, "block", None)
    is_own = finest.name == one.name and one.model.get("block", block) == block
    if is_own or finest.name == exact:
        return finest, 0.0
    found = _reference(made.scene, exact or one.name, one.model, made.asked, finest.result)
    return found, misfit(found.result, finest.result) + finest.error


def _reference(
    scene: AnyScene,
    name: str,
    model: dict[str, Any],
    asked: float,
    finest: xr.Dataset | None = None,
) -> Reference:
    """Return an exact solution, or a converged run, whose error is below a tenth of the misfit.

    A larger error suffices once the model is certainly further from `finest` than the misfit.
    Raises SceneError if no such accuracy is reached.
    """
    is_run = name in ENGINES
    for found in _runs(scene, name, model) if is_run else [exact_reference(name, plain(scene))]:
        is_far = finest is not None and misfit(found.result, finest) - found.error > asked
        if JUDGED * found.error <= asked or is_far:
            return found
    why = f"is known to {100 * found.error:.2g} %, not to {100 * asked / JUDGED:.2g} %"
    why = f"{why}: ask for a larger --misfit" if found.error < inf else "has no finer run in reach"
    raise SceneError(scene.where, "", None, f"{label(name, model)} {why}")


def _runs(scene: AnyScene, name: str, model: dict[str, Any]) -> Iterator[Reference]:
    """Yield runs of a model, each with at most half the previous step and, in rock, finer elements.

    The stated error, the distance from the previous run, is a bound if the order is at least one.
    """
    is_rigid, before = ENGINES[name].has_rigid_blocks, None
    one = elements(scene, name, model if is_rigid else choices.EXPLICIT | choices.rock(scene, 2))
    one = one._replace(per_sample=2 * one.per_sample)
    while before is None or one.seconds <= LONGEST[scene.kind]:
        result = one.solve()
        apart = inf if before is None else misfit(before, result)
        yield Reference(name, result, apart, ", ".join(f"{k} {v}" for k, v in one.numerics.items()))
        if not (finer := [one] if is_rigid else one.finer()):
            break
        per_sample = 2 * max(one.per_sample, finer[0].per_sample)
        before, one = result, finer[0]._replace(per_sample=per_sample)
