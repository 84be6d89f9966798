"""One point of a study, measured: its errors, counts, time and memory."""

import math
from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import xarray as xr

from cases.errors import SceneError
from cases.kinds import AnyScene, pillar_of
from compare.engines import ENGINES, applies, solve, solver, stepping
from compare.experiments.study.methods import METHODS
from compare.experiments.study.reference import UNKNOWN, error, finest_of, known, own_of
from compare.experiments.study.study import StudyPoint
from compare.solvers.record import Answer
from compare.studies.store import FAILURES

LONG = 0.1  # s: longer steps are timed once, and repeats begin for no longer


class PointRow(NamedTuple):
    """A point in the table of a study; numbers that a method does not have are nan.

    state : "done" or "failed", with the reason in `message`.
    numerical : misfit from the exact solution of the method's own model; modelling : of that from
        the finest physics; total : sum of both and their floors, an upper bound. measured :
        from the finest physics, where the two may cancel.
    numerical_floor, total_floor : below which they are not known, 0 against closed forms.
    held : the largest total of this and all finer points of the curve, or numerical error if no
        total is known: the error assigned to it. cancels : whether it measures less than that.
    steps : of time. work : freedoms times evaluations of all forces, which are
        degree-of-freedom-steps where a step takes one. bytes : of the model and its state.
    seconds, spread : stepping, median and half the range of the repeats, or of the
        first run where that takes long; setup, compile : of the first run.
    """

    curve: str
    method: str
    settings: dict[str, Any]
    state: str
    message: str
    numerical: float
    modelling: float
    total: float
    measured: float
    numerical_floor: float
    total_floor: float
    dt: float
    steps: float
    freedoms: float
    work: float
    bytes: float
    seconds: float
    spread: float
    setup: float
    compile: float
    held: float
    cancels: bool


def measure(point: StudyPoint) -> PointRow:
    """Run a point and return its row; a point that fails gives a row with the reason."""
    try:
        return _measured(point)
    except FAILURES as error:
        return _row(point, "failed", str(error))


def _measured(point: StudyPoint) -> PointRow:
    study, run = point.study, runner(point, point.scene)
    result = run()

    def counted(*names: str) -> float:
        """Return the first of these attributes that the result has."""
        return float(next((result.attrs[x] for x in names if x in result.attrs), math.nan))

    seconds = [counted("seconds_stepping")]
    if study.timed and not seconds[0] > LONG:
        seconds = _repeated(_again(point, run), study.repeats)
    own = known(own_of(point), study, point.physics)
    finest = known(finest_of(study), study, {})
    numerical = error(result, own, study)
    modelling = UNKNOWN if own is None else error(own.result, finest, study)
    floor = numerical.floor + modelling.floor
    freedoms = counted("degrees_of_freedom")
    # Forces are evaluated in stages, by Newton's method, or once per step.
    evaluations = counted("force_evaluations", "newton_iterations", "steps")
    return _row(
        point,
        "done",
        "",
        numerical=numerical.misfit,
        modelling=modelling.misfit,
        total=numerical.misfit + modelling.misfit + floor,
        measured=error(result, finest, study).misfit,
        numerical_floor=numerical.floor,
        total_floor=floor,
        dt=counted("dt"),
        steps=counted("steps"),
        freedoms=freedoms,
        work=evaluations * freedoms,
        bytes=counted("bytes"),
        seconds=median(seconds),
        spread=(max(seconds) - min(seconds)) / 2,
        setup=counted("seconds_setup"),
        compile=counted("seconds_compile"),
    )


def runner(point: StudyPoint, scene: AnyScene) -> Callable[[], xr.Dataset]:
    """Return the function that solves a point once."""
    method, arguments = point.curve.method, point.arguments
    if not (answer := method_applies(point, scene)):
        raise SceneError(scene.title, "", None, f"{method} does not apply: {answer.reason}")
    if method in METHODS:
        return lambda: METHODS[method].solve(pillar_of(scene, method), **arguments)
    if arguments:
        return lambda: _timed(lambda: solver(method).run(scene, **arguments))
    return lambda: _timed(lambda: solve(method, scene))


def method_applies(point: StudyPoint, scene: AnyScene) -> Answer:
    """Return whether a point's method applies to its scene, or the reason why not."""
    method = point.curve.method
    if method not in METHODS:
        return applies(method, scene)
    return METHODS[method].applies(pillar_of(scene, method))


def _timed(run: Callable[[], xr.Dataset]) -> xr.Dataset:
    """Return a result with its cost, exact solutions included."""
    began = perf_counter()
    result = run()
    result.attrs.setdefault("seconds_stepping", perf_counter() - began)
    return result


def _again(point: StudyPoint, run: Callable[[], xr.Dataset]) -> Callable[[], float]:
    """Return what takes the steps of a point anew at each call and returns their seconds."""
    if point.curve.method in ENGINES:
        return stepping(point.curve.method, point.scene)
    return lambda: float(run().attrs["seconds_stepping"])


def _repeated(again: Callable[[], float], repeats: int) -> list[float]:
    """Return the stepping seconds of repeats, now that everything is compiled."""
    found: list[float] = []
    began = perf_counter()
    while len(found) < repeats and perf_counter() - began < LONG:
        found.append(again())
    return found


def _row(point: StudyPoint, state: str, message: str, **numbers: float) -> PointRow:
    about = (point.curve.label, point.curve.method, point.settings, state, message)
    # The last two are known once the curve is complete.
    values = (numbers.get(name, math.nan) for name in PointRow._fields[len(about) : -2])
    return PointRow._make((*about, *values, math.nan, False))
