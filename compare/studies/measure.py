"""One point of a study, measured: its errors against references, its counts, time and memory.

References are exact solutions, or fine runs whose own error is bounded. Columns of a row:

state : "done" or "failed", with the reason in `message`.
numerical : misfit from the exact solution of the method's own model. modelling : misfit of that
    solution from the finest physics. total : upper bound, the sum of both and of their floors.
    measured : misfit from the finest physics, in which the two errors may cancel.
numerical_floor, total_floor : errors of the references; smaller errors are not known. 0 for closed
    forms.
dt : s. steps : of time. work : freedoms times force evaluations. bytes : of the model and state.
seconds, spread : stepping, median and half the range of the repeats; of one run if it takes long.
setup, compile : of the first run.
"""

from collections.abc import Sequence
from math import nan
from statistics import median
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, EXACT, applies, solver
from jointwave.compare.misfit.metrics import Worst, pairings, relative_l2, worst
from jointwave.compare.misfit.ranking import applicable, finest, own_exact
from jointwave.compare.runs.timings import solved
from jointwave.compare.studies.store import FAILURES, Row
from jointwave.compare.studies.study import FINEST, NONE, FineRun, Study, StudyPoint
from jointwave.results.dataset import scene_hash

LONG = 0.1  # s of stepping; longer runs are timed once


#: Columns of a point's row; unknown numbers are missing.
WORDS = ("curve", "method", "settings", "state", "message")
ERRORS = ("numerical", "modelling", "total", "measured", "numerical_floor", "total_floor")
COUNTS = ("dt", "steps", "freedoms", "work", "bytes", "seconds", "spread", "setup", "compile")


class Reference(NamedTuple):
    """The reference of errors.

    error : of the reference itself, relative: 0 for a closed form, the bound of a computed
    solution, for a run the distance from a coarser one. settings : of a run, else "".
    """

    name: str
    result: xr.Dataset
    error: float
    settings: str = ""


def measure(point: StudyPoint) -> Row:
    """Run a point and return its row; a point that fails gives a row with the reason."""
    study, about = point.study, (point.curve.label, point.curve.method, point.settings)
    row: Row = dict(zip(WORDS, (*about, "done", ""), strict=True))
    try:
        result = _run(point)
        seconds = [float(result.attrs["seconds_stepping"])]
        if study.timed and study.repeats > 1 and seconds[0] <= LONG:  # all is compiled by now
            again = (_run(point) for _ in range(study.repeats))
            seconds = [float(one.attrs["seconds_stepping"]) for one in again]
        took = {"seconds": median(seconds), "spread": (max(seconds) - min(seconds)) / 2}
        return row | errors(point, result) | _counts(result) | took
    except FAILURES as failure:
        return row | {"state": "failed", "message": str(failure)}


def _run(point: StudyPoint) -> xr.Dataset:
    """Return the result of a point; raises SceneError if its method does not apply."""
    result, seconds = solved(point.curve.method, point.scene)
    result.attrs.setdefault("seconds_stepping", seconds)  # of exact solutions
    return result


def is_valid(point: StudyPoint) -> bool:
    """Return whether the scene of a point is valid and its method applies."""
    try:
        return bool(applies(point.curve.method, point.scene))
    except SceneError:
        return False


def _counts(result: xr.Dataset) -> dict[str, float]:
    about = result.attrs
    # Forces are evaluated once per stage, per Newton iteration, or per step.
    counted = ("force_evaluations", "newton_iterations", "steps")
    evaluations = next((about[x] for x in counted if x in about), nan)
    names = {"freedoms": "degrees_of_freedom", "setup": "seconds_setup"}
    names |= {"compile": "seconds_compile", "dt": "dt", "steps": "steps", "bytes": "bytes"}
    found = {name: float(about.get(key, nan)) for name, key in names.items()}
    return found | {"work": float(evaluations) * found["freedoms"]}


def errors(point: StudyPoint, result: xr.Dataset) -> dict[str, float]:
    """Return the errors of a result and their floors by column; nan if unknown."""
    study = point.study
    own = _known(own_of(point), study, point.physics)
    finest = _known(finest_of(study), study, {})
    numerical, numerical_floor = _error(result, own, study)
    modelling, modelling_floor = _error(own.result, finest, study) if own else (nan, nan)
    floor = numerical_floor + modelling_floor
    return {
        "numerical": numerical,
        "modelling": modelling,
        "total": numerical + modelling + floor,
        "measured": _error(result, finest, study)[0],
        "numerical_floor": numerical_floor,
        "total_floor": floor,
    }


def able(scene: AnyScene) -> list[str]:
    """Return the names of all solvers that apply to a scene."""
    return [name for name, answer in applicable(scene).items() if answer]


def finest_of(study: Study) -> str | FineRun | None:
    """Return the reference of total errors: the one set by the study, else the finest solver that
    applies if it is an exact solution, else None."""
    if study.finest is not None:
        return None if study.finest == NONE else study.finest
    found = finest(able(study.base), study.base)
    return None if found is None or found.name in ENGINES else found.name


def own_of(point: StudyPoint) -> str | FineRun | None:
    """Return the reference of a point's numerical error: the one set by its curve, else the exact
    solution of its own model, else a run of its method as fine as the study's fine run, if that is
    of the same engine, else None."""
    own, study, scene = point.curve.own, point.study, point.scene
    if own is not None:
        return finest_of(study) if own == FINEST else None if own == NONE else own
    engine = point.curve.method
    exact = own_exact(engine, [name for name in EXACT if applies(name, scene)], scene)
    if exact or not isinstance(study.finest, FineRun):
        return exact
    alike = solver(engine).engine == solver(study.finest.method).engine
    return study.finest.model_copy(update={"method": engine}) if alike else None


def references(points: Sequence[StudyPoint]) -> list[tuple[str, AnyScene]]:
    """Return solver and scene of every reference of some points, without repetitions."""
    found: dict[tuple[str, str], tuple[str, AnyScene]] = {}
    for point in points:
        for against, physics in ((own_of(point), point.physics), (finest_of(point.study), {})):
            if against is not None:
                name, *scenes = _scenes_of(against, point.study, physics)
                found |= {(name, scene_hash(scene)): (name, scene) for scene in scenes}
    return list(found.values())


def _scenes_of(against: str | FineRun, study: Study, physics: dict[str, Any]) -> tuple[Any, ...]:
    """Return the solver and scene of a reference; for a fine run also the coarser scene."""
    if isinstance(against, str):
        scene = study.changed(physics)  # an exact solution has no numerics
        return against, scene.model_copy(update={"numerics": type(scene.numerics)(), "expect": {}})
    changes = physics | against.changes
    return against.method, study.changed(changes), study.changed(changes | against.coarser)


def _known(
    against: str | FineRun | None, study: Study, physics: dict[str, Any]
) -> Reference | None:
    """Return a solved reference for the study's scene with changed physics; None if none is set."""
    if against is None:
        return None
    name, *scenes = _scenes_of(against, study, physics)
    if isinstance(against, str):
        return exact_reference(name, *scenes)
    fine, coarse = (_solved(name, scene) for scene in scenes)
    return Reference(name, fine, _misfit(coarse, fine, study), str(against.changes))


def exact_reference(name: str, scene: AnyScene) -> Reference:
    """Return an exact solution with the bound of its own error."""
    result = _solved(name, scene)
    return Reference(name, result, worst(result, result).floor)


def _error(result: xr.Dataset, against: Reference | None, study: Study) -> tuple[float, float]:
    """Return the error of a result and its floor, the error of the reference; both 0 for the
    reference itself, nan without a reference."""
    if against is None:
        return nan, nan
    if result is against.result:
        return 0.0, 0.0
    return _misfit(result, against.result, study), against.error


_solutions: dict[tuple[str, str], xr.Dataset] = {}


def _solved(name: str, scene: AnyScene) -> xr.Dataset:
    """Return a solution, computed once per process."""
    key = name, scene_hash(scene)
    if key not in _solutions:
        _solutions[key], _ = solved(name, scene)
    return _solutions[key]


def _misfit(one: xr.Dataset, other: xr.Dataset, study: Study) -> float:
    """Return the misfit of the worst waveform; if the study names a quantity, its relative L2
    misfit over time and all receivers, of the worst component."""
    if study.quantity is None:
        return worst(one, other).misfit
    by_component: dict[str, list[Worst]] = {}
    for pair in pairings(one, other):
        if pair.place.quantity == study.quantity:
            by_component.setdefault(pair.place.component, []).append(pair)
    both = ([(p.one, p.other) for p in pairs] for pairs in by_component.values())
    return max((relative_l2(*np.array(waves).swapaxes(0, 1)) for waves in both), default=nan)
