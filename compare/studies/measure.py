"""One point of a study, measured: its errors, counts, time and memory."""

from math import nan
from statistics import median
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import applies
from jointwave.compare.runs.timings import solved
from jointwave.compare.studies.reference import errors
from jointwave.compare.studies.store import FAILURES
from jointwave.compare.studies.study import StudyPoint

LONG = 0.1  # s: longer steps are timed once


class PointRow(NamedTuple):
    """A point in the table of a study; numbers that a method does not have are nan.

    state : "done" or "failed", with the reason in `message`.
    numerical : misfit from the exact solution of the method's own model; modelling : of that from
        the finest physics; total : sum of both and their floors, an upper bound. measured :
        from the finest physics, where the two may cancel.
    numerical_floor, total_floor : below which they are not known, 0 against closed forms.
    dt : s. steps : of time. work : freedoms times evaluations of all forces, which are
        degree-of-freedom-steps where a step takes one. bytes : of the model and its state.
    seconds, spread : stepping, median and half the range of the repeats, or of the
        first run where that takes long; setup, compile : of the first run.
    """

    curve: str
    method: str
    settings: dict[str, Any]
    state: str
    message: str
    numerical: float = nan
    modelling: float = nan
    total: float = nan
    measured: float = nan
    numerical_floor: float = nan
    total_floor: float = nan
    dt: float = nan
    steps: float = nan
    freedoms: float = nan
    work: float = nan
    bytes: float = nan
    seconds: float = nan
    spread: float = nan
    setup: float = nan
    compile: float = nan


def measure(point: StudyPoint) -> PointRow:
    """Run a point and return its row; a point that fails gives a row with the reason."""
    row = PointRow(point.curve.label, point.curve.method, point.settings, "done", "")
    study = point.study
    try:
        result = _run(point)
        seconds = [float(result.attrs["seconds_stepping"])]
        if study.timed and study.repeats > 1 and seconds[0] <= LONG:  # all is compiled by now
            again = (_run(point) for _ in range(study.repeats))
            seconds = [float(one.attrs["seconds_stepping"]) for one in again]
        found = errors(point, result) | _counts(result)
        spread = (max(seconds) - min(seconds)) / 2
        return row._replace(**found, seconds=median(seconds), spread=spread)  # type: ignore[arg-type]
    except FAILURES as failure:
        return row._replace(state="failed", message=str(failure))


def _run(point: StudyPoint) -> xr.Dataset:
    """Return the result of a point; raises SceneError if its method does not apply."""
    result, seconds = solved(point.curve.method, point.scene)
    result.attrs.setdefault("seconds_stepping", seconds)  # of exact solutions
    return result


def is_valid(point: StudyPoint) -> bool:
    """Return whether a point has a scene, to which its method applies."""
    try:
        return bool(applies(point.curve.method, point.scene))
    except SceneError:
        return False


def _counts(result: xr.Dataset) -> dict[str, float]:
    def first(*names: str) -> float:
        return float(next((result.attrs[x] for x in names if x in result.attrs), nan))

    freedoms = first("degrees_of_freedom")
    # Forces are evaluated in stages, by Newton's method, or once per step.
    evaluations = first("force_evaluations", "newton_iterations", "steps")
    return {
        "dt": first("dt"),
        "steps": first("steps"),
        "freedoms": freedoms,
        "work": evaluations * freedoms,
        "bytes": first("bytes"),
        "setup": first("seconds_setup"),
        "compile": first("seconds_compile"),
    }
