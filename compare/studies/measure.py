"""One point of a study, measured: its errors, what was counted, and what it took."""

import math
from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import xarray as xr

from cases.errors import SceneError, StoppedError, UnstableError
from cases.result import scene_hash
from cases.scene import Scene
from cases.tables import Numerics
from compare.engines import solve
from compare.metrics import misfit, relative_l2
from compare.studies.methods import METHODS
from compare.studies.study import Point

LONG = 2.0  # s: a run that takes as long is timed once more at most


class Row(NamedTuple):
    """What a study's table holds of one point; numbers that a method does not have are nan.

    state : "done" or "failed", with the reason in `message`.
    numerical : misfit against the exact solution of the method's own model; total : against the
        finest physics. steps : of time. work : freedoms times evaluations of all forces, which are
        degree-of-freedom-steps where a step takes one. bytes : of the model and its state.
    seconds, spread : stepping, median and half the range of the repeats; setup, compile : of the
        first run.
    """

    curve: str
    method: str
    settings: dict[str, Any]
    state: str
    message: str
    numerical: float
    total: float
    dt: float
    steps: float
    freedoms: float
    work: float
    bytes: float
    seconds: float
    spread: float
    setup: float
    compile: float


TIMED = ("seconds", "spread", "setup", "compile")  # all other columns are the same in every run


def measure(point: Point) -> Row:
    """Run a point and return its row; what cannot be run is a row that says why."""
    try:
        return _measured(point)
    except (SceneError, UnstableError, StoppedError) as error:
        return _row(point, "failed", str(error))


def _measured(point: Point) -> Row:
    scene, study = point.scene, point.study
    run = runner(point, scene)
    result = run()
    first = result.attrs
    seconds = [float(first.get("seconds_stepping", math.nan))]
    if study.timed:
        seconds = _repeated(run, study.repeats)
    steps, freedoms = first.get("steps", math.nan), first.get("degrees_of_freedom", math.nan)
    return _row(
        point,
        "done",
        "",
        numerical=_error(result, point.curve.own, scene, study.quantity),
        total=_error(result, study.finest, study.base, study.quantity),
        dt=float(first.get("dt", math.nan)),
        steps=float(steps),
        freedoms=float(freedoms),
        work=_evaluations(first) * float(freedoms),
        bytes=float(first.get("bytes", math.nan)),
        seconds=median(seconds),
        spread=(max(seconds) - min(seconds)) / 2,
        setup=float(first.get("seconds_setup", math.nan)),
        compile=float(first.get("seconds_compile", math.nan)),
    )


def _evaluations(attributes: dict[str, Any]) -> float:
    """Return how often all forces were evaluated: in stages, by Newton's method, once a step."""
    names = ("force_evaluations", "newton_iterations", "steps")
    return float(next((attributes[name] for name in names if name in attributes), math.nan))


def runner(point: Point, scene: Scene) -> Callable[[], xr.Dataset]:
    """Return the function that solves a point once."""
    method, arguments = point.curve.method, point.arguments
    if method in METHODS:
        return lambda: METHODS[method](scene, **arguments)
    if arguments:
        from compare.exact.catalogue import CATALOGUE

        return lambda: _timed(lambda: CATALOGUE[method].solve(scene, **arguments))
    return lambda: _timed(lambda: solve(method, scene))


def _timed(run: Callable[[], xr.Dataset]) -> xr.Dataset:
    """Return a result that says what it took, exact solutions included."""
    began = perf_counter()
    result = run()
    result.attrs.setdefault("seconds_stepping", perf_counter() - began)
    return result


def _repeated(run: Callable[[], xr.Dataset], repeats: int) -> list[float]:
    """Return the stepping seconds of repeats, now that everything is compiled."""
    found: list[float] = []
    while len(found) < repeats and sum(found) < LONG:
        found.append(float(run().attrs["seconds_stepping"]))
    return found


def _error(result: xr.Dataset, name: str | None, scene: Scene, quantity: str | None) -> float:
    """Return the misfit against an exact solution or engine; nan without one."""
    if name is None:
        return math.nan
    exact = reference(name, scene)
    if quantity is None:
        return misfit(result, exact)
    return relative_l2(result[quantity].values, exact[quantity].values)


def reference(name: str, scene: Scene) -> xr.Dataset:
    """Return what errors are measured against, at its default numerics; solved once a process."""
    plain = scene.model_copy(update={"numerics": Numerics(), "expect": {}})
    key = name, scene_hash(plain)
    if key not in _references:
        _references[key] = solve(name, plain)
    return _references[key]


_references: dict[tuple[str, str], xr.Dataset] = {}


def _row(point: Point, state: str, message: str, **numbers: float) -> Row:
    about = (point.curve.label, point.curve.method, point.settings, state, message)
    return Row(*about, *(numbers.get(name, math.nan) for name in Row._fields[len(about) :]))
