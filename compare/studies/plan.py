"""The cheapest way to solve a scene within a misfit: runs from cheap to dear until one meets it.

The criterion is the sum of two errors: the numerical one, of a run from its engine's own model, and
the modelling one, of that model from the finest physics. Errors that happen to cancel are therefore
no accuracy, and a run meets the misfit only if the runs of smaller steps do so, too: one at least.

A run that misses it is followed by one of half its step and, the first time, by elements of half
the size. Their expected time, from the rates of this machine, decides which is next.
"""

from dataclasses import dataclass, field
from math import ceil, inf
from time import perf_counter
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress, solve
from jointwave.compare.misfit import ranking
from jointwave.compare.misfit.metrics import JUDGED, misfit, worst
from jointwave.compare.runs import timings
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
from jointwave.compare.studies.reference import Reference
from jointwave.compare.studies.store import FAILURES, reason_of

SHARE = 1 / JUDGED  # of the requested misfit: largest error of a reference
LONGEST = {"pillar": 20.0, "rock mass": 60.0}  # s of stepping: no run is longer, unless asked for
FINE = 0.4  # of the critical step, in a converged run
LEVELS = 10
#: Least growth in degrees of freedom of quadratic elements of half the size: 5 / 3 along a block of
#: one element, 25 / 9 in a quadrilateral.
GROWN = {"pillar": 1.5, "rock mass": 2.5}
MOST_HALVINGS = 4  # of elements at once, until there are more of them
STALLED = 0.8  # of the error before: smaller steps no longer help


class OwnModel(NamedTuple):
    """The model of an engine: the reference of its numerical errors, and an upper bound on its
    distance from the finest physics, 0 if it is the finest physics itself."""

    reference: Reference
    modelling: float

    @property
    def least(self) -> float:
        """The error that no step reduces: modelling error plus that of the own reference."""
        return self.modelling + self.reference.error


class PlannedRun(NamedTuple):
    """A run, its numerical and modelling error with those of their references, and its seconds of
    stepping. numerics : of its engine."""

    elements: Elements
    per_sample: int
    numerical: float
    modelling: float
    seconds: float

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error, without regard to cancellation."""
        return self.numerical + self.modelling

    @property
    def options(self) -> list[str]:
        """The values of `--set` that make it."""
        table = ENGINES[self.elements.name].engine
        numerics = self.elements.numerics(self.per_sample)
        return [f"numerics.{table}.{key}={value}" for key, value in numerics.items()]


@dataclass
class Plan:
    """The runs of a scene, from cheap to dear, and the choice among them.

    asked : the misfit. limit : s of stepping, None without. finest : the finest physics, and the
    reason for it. own : the engines' models by name; an error where none was found.
    skipped : what could not or need not be run, with the reason. planning : s.
    """

    scene: AnyScene
    asked: float
    limit: float | None
    finest: Reference
    reason: str
    own: dict[str, OwnModel | SceneError] = field(default_factory=dict)
    runs: list[PlannedRun] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)
    planning: float = 0.0

    @property
    def chosen(self) -> PlannedRun | None:
        """The cheapest run that meets the misfit; without one, the most accurate within the limit,
        None if there is no limit."""
        meets = (run for run in self.runs if self.held(run) <= self.asked)
        best = min(meets, key=lambda run: run.seconds, default=None)
        if self.limit is None or (best is not None and best.seconds <= self.limit):
            return best
        in_time = (run for run in self.runs if run.seconds <= self.limit)
        return min(in_time, key=self.accuracy, default=None)

    @property
    def nearest(self) -> PlannedRun | None:
        """The most accurate run; of several the finest, which is no luck."""
        return min(self.runs, key=lambda x: (self.accuracy(x), -x.per_sample), default=None)

    @property
    def misfit(self) -> float:
        """Sum of numerical and modelling error of the chosen run; inf without one."""
        return inf if self.chosen is None else self.accuracy(self.chosen)

    @property
    def is_met(self) -> bool:
        """Whether the chosen run meets the misfit."""
        return self.chosen is not None and self.held(self.chosen) <= self.asked

    @property
    def seconds(self) -> float:
        """Seconds of stepping of the chosen run; 0 without one."""
        return 0.0 if self.chosen is None else self.chosen.seconds

    def accuracy(self, run: PlannedRun) -> float:
        """Return the largest misfit of a run and of smaller steps of its elements."""
        alike = (one for one in self.runs if one.elements is run.elements)
        return max(one.misfit for one in alike if one.per_sample >= run.per_sample)

    def held(self, run: PlannedRun) -> float:
        """Return the same; inf where there is no run of smaller steps, since it may be luck."""
        alike = (one for one in self.runs if one.elements is run.elements)
        smaller = any(one.per_sample > run.per_sample for one in alike)
        return self.accuracy(run) if smaller else inf

    def own_reference(self, run: PlannedRun) -> Reference:
        """Return the reference of a run's numerical error."""
        return own_model(self, run.elements).reference


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
    finest = _reference(scene, found.name, {}, misfit, None)
    made = Plan(scene, misfit, seconds, finest, found.reason)
    queue = [start for name, changes in coarsest(scene) for start in _entered(made, name, changes)]
    while queue:
        one, per_sample = min(queue, key=lambda pair: pair[0].seconds(pair[1]))
        if one.seconds(per_sample) > _limit(made):
            break
        queue.remove((one, per_sample))
        try:
            queue += _tried(made, one, per_sample)
        except FAILURES as error:
            made.skipped[one.label] = reason_of(error)
        if progress:
            progress(1 - 0.9 ** len(made.runs))
    made.planning = perf_counter() - began
    return made


def _limit(made: Plan) -> float:
    """Return the seconds above which a run is useless, or too long."""
    if made.chosen is not None and made.is_met:
        return made.chosen.elements.seconds(made.chosen.per_sample)
    if made.limit is not None:
        return made.limit
    return LONGEST[made.scene.kind] - sum(run.seconds for run in made.runs)


def _entered(made: Plan, name: str, changes: dict[str, Any]) -> list[tuple[Elements, int]]:
    """Return elements with their coarsest step, to be tried; none if the scene cannot have them."""
    try:
        one = elements(made.scene, name, changes)
    except FAILURES as error:
        made.skipped[label(name, changes)] = reason_of(error)
        return []
    return [(one, one.least)]


def _tried(made: Plan, one: Elements, per_sample: int) -> list[tuple[Elements, int]]:
    """Run elements with so many steps per sample, and with twice as many if they meet the misfit;
    return what is to be tried next."""
    own = own_model(made, one)
    if own.least >= made.asked and made.limit is None:
        model = label(one.name, one.model)
        reason = f"the modelling error of {model} is already {100 * own.least:.3g} %"
        made.skipped[one.label] = reason
        return _refined(made, one) if one.model else []
    result = solve(one.name, one.with_steps(per_sample))
    timings.note(one.name, one.scene, result.attrs)
    numerical = misfit(result, own.reference.result) + own.reference.error
    seconds = float(result.attrs["seconds_stepping"])
    made.runs.append(PlannedRun(one, per_sample, numerical, own.modelling, seconds))
    *before, run = (run for run in made.runs if run.elements is one)
    missed = [run for run in before if run.misfit > made.asked]
    if run.misfit <= made.asked:
        is_confirmed = len(before) > len(missed) and before[-1] not in missed
        return [] if is_confirmed else _tried(made, one, 2 * per_sample)
    finer = [] if missed else _refined(made, one)
    is_stalled = bool(missed) and numerical > STALLED * missed[-1].numerical
    return finer if is_stalled else [*finer, (one, 2 * per_sample)]


def _refined(made: Plan, one: Elements) -> list[tuple[Elements, int]]:
    """Return elements, or blocks, of half the size or less, to be tried: a block may be smaller
    than requested, and a given mesh is not refined."""
    changes = one.changes
    for _ in range(MOST_HALVINGS):
        if not (changes := halved(changes)):
            return []
        entered = _entered(made, one.name, changes)
        if not entered or entered[0][0].run.freedoms > one.run.freedoms:
            return entered
    return []


def own_model(made: Plan, one: Elements) -> OwnModel:
    """Return the model of elements; raises SceneError if no run of it has converged."""
    key = label(one.name, one.model)
    if key not in made.own:
        try:
            made.own[key] = _found_own(made, one)
        except SceneError as error:
            made.own[key] = error
    found = made.own[key]
    if isinstance(found, SceneError):
        raise found
    return found


def _found_own(made: Plan, one: Elements) -> OwnModel:
    scene, finest = configured(made.scene, one.name, one.model), made.finest
    exact = ranking.own_exact(one.name, _applicable(scene), scene)
    block = getattr(made.scene.numerics.dem, "block", None)
    is_own = finest.name == one.name and one.model.get("block", block) == block
    if is_own or finest.name == exact:
        return OwnModel(finest, 0.0)
    reference = _reference(made.scene, exact or one.name, one.model, made.asked, finest.result)
    return OwnModel(reference, misfit(reference.result, finest.result) + finest.error)


def _applicable(scene: AnyScene) -> list[str]:
    return [name for name, answer in ranking.applicable(scene).items() if answer]


def _reference(
    scene: AnyScene,
    name: str,
    model: dict[str, Any],
    asked: float,
    finest: xr.Dataset | None,
) -> Reference:
    """Return an exact solution, or a converged run of a model, each known to a tenth of a misfit.

    Raises SceneError if it is not.
    """
    if name in ENGINES:
        return _converged(scene, name, model, asked, finest)
    result = solve(name, plain(scene))
    error = worst(result, result).floor
    if error > SHARE * asked:
        raise _not_known(scene, f"{name} knows itself", error, asked)
    return Reference(name, result, error)


def _converged(
    scene: AnyScene, name: str, model: dict[str, Any], asked: float, finest: xr.Dataset | None
) -> Reference:
    """Return a model's run that differs little enough from the previous one.

    Each has at most half the step, and half the elements' size, of the previous one. Its error is
    at most the difference if the error falls at least in proportion to the step. A run also
    suffices once its model is certain to be further from the finest physics than requested.
    """
    rigid, apart, before, steps, freedoms = ENGINES[name].has_rigid_blocks, inf, None, 0, 0.0
    for level in range(LEVELS):
        one = elements(scene, name, model if rigid else EXPLICIT | rock(scene, 2, 2**level))
        if not rigid and one.run.freedoms < GROWN[scene.kind] * freedoms:
            continue
        steps = max(2 * steps, ceil(one.least * COARSEST / FINE))
        if before is not None and one.seconds(steps) > LONGEST[scene.kind]:
            break
        result = solve(name, one.with_steps(steps))
        timings.note(name, scene, result.attrs)
        apart = inf if before is None else misfit(before, result)
        is_far = finest is not None and misfit(result, finest) - apart > asked
        if apart < SHARE * asked or is_far:
            made = ", ".join(f"{k} {v}" for k, v in one.numerics(steps).items())
            return Reference(name, result, apart, made)
        before, freedoms = result, one.run.freedoms
    longest = LONGEST[scene.kind]
    what = f"no exact solution to plan by, and {label(name, model)} within {longest:g} s a run"
    if apart == inf:
        raise SceneError(scene.where, "", None, f"{what} has no finer elements to compare with")
    raise _not_known(scene, f"{what} converges", apart, asked)


def _not_known(scene: AnyScene, what: str, error: float, asked: float) -> SceneError:
    """Return the error for a reference that is not accurate enough."""
    share = f"to {100 * error:.2g} %, not to {100 * SHARE * asked:.2g} %"
    return SceneError(scene.where, "", None, f"{what} {share}: ask for a larger --misfit")
