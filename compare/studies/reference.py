"""References of errors: exact solutions, or fine runs whose own error is bounded."""

from collections.abc import Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, EXACT, applies, solver
from jointwave.compare.misfit.metrics import Worst, pairings, relative_l2, worst
from jointwave.compare.misfit.ranking import applicable, finest, own_exact
from jointwave.compare.runs.timings import solved
from jointwave.compare.studies.study import FINEST, NONE, FineRun, Study, StudyPoint
from jointwave.results.dataset import scene_hash


class Reference(NamedTuple):
    """The reference of errors.

    error : relative, of the reference itself: the bound of a computed solution, 0 for a closed
    form; for a run its distance from a coarser one. settings : of a run, "" for an exact solution.
    """

    name: str
    result: xr.Dataset
    error: float
    settings: str = ""


def exact_reference(name: str, scene: AnyScene) -> Reference:
    """Return an exact solution with the bound of its own error."""
    result = _solved(name, scene)
    return Reference(name, result, worst(result, result).floor)


def finest_of(study: Study) -> str | FineRun | None:
    """Return the reference of total errors: as set by the study, else the finest exact solution;
    None if the finest that applies is an engine and the study gives no fine run of it."""
    if study.finest is not None:
        return None if study.finest == NONE else study.finest
    scene = study.changed({})
    found = finest([name for name, answer in applicable(scene).items() if answer], scene)
    return None if found is None or found.name in ENGINES else found.name


def own_of(point: StudyPoint) -> str | FineRun | None:
    """Return the reference of a point's numerical error: as set by its curve, else the exact
    solution of its own model, else a run of its engine as fine as the study's; None without."""
    own, study, scene = point.curve.own, point.study, point.scene
    if own is not None:
        return finest_of(study) if own == FINEST else None if own == NONE else own
    engine = point.curve.method
    exact = own_exact(engine, [name for name in EXACT if applies(name, scene)], scene)
    if exact or not isinstance(study.finest, FineRun):
        return exact
    alike = solver(engine).engine == solver(study.finest.method).engine
    return study.finest.model_copy(update={"method": engine}) if alike else None


def errors(point: StudyPoint, result: xr.Dataset) -> dict[str, float]:
    """Return the errors of a result and their floors, as `PointRow` has them; nan if unknown."""
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


def _known(
    against: str | FineRun | None, study: Study, physics: dict[str, Any]
) -> Reference | None:
    """Return a reference of the study's scene with some physics changed; None without."""
    if against is None:
        return None
    scenes = _scenes_of(against, study, physics)
    if isinstance(against, str):
        return exact_reference(against, *scenes)
    fine, coarse = (_solved(against.method, scene) for scene in scenes)
    return Reference(against.method, fine, _misfit(coarse, fine, study), str(against.changes))


def _scenes_of(against: str | FineRun, study: Study, physics: dict[str, Any]) -> list[AnyScene]:
    """Return the scene of an exact reference, or of a fine run and of the coarser one."""
    if isinstance(against, str):
        scene = study.changed(physics)  # an exact solution has no numerics
        numerics: dict[str, Any] = {"numerics": type(scene.numerics)(), "expect": {}}
        return [scene.model_copy(update=numerics)]
    changes = physics | against.changes
    return [study.changed(changes), study.changed(changes | against.coarser)]


def references(points: Sequence[StudyPoint]) -> list[tuple[str, AnyScene]]:
    """Return the solver and the scene of every reference of some points, each once."""
    found: dict[tuple[str, str], tuple[str, AnyScene]] = {}
    for point in points:
        for against, physics in ((own_of(point), point.physics), (finest_of(point.study), {})):
            if against is not None:
                name = against if isinstance(against, str) else against.method
                for scene in _scenes_of(against, point.study, physics):
                    found[name, scene_hash(scene)] = name, scene
    return list(found.values())


def _error(result: xr.Dataset, against: Reference | None, study: Study) -> tuple[float, float]:
    """Return the error of a result, and its floor, below which it is not known; 0 of a reference
    itself, nan without one."""
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
    """Return the misfit of the worst waveform; for a single quantity, the relative L2 norm over
    time and all its receivers, of the worst component."""
    if study.quantity is None:
        return worst(one, other).misfit
    by_component: dict[str, list[Worst]] = {}
    for pair in pairings(one, other):
        if pair.place.quantity == study.quantity:
            by_component.setdefault(pair.place.component, []).append(pair)
    both = ([(p.one, p.other) for p in pairs] for pairs in by_component.values())
    return max((relative_l2(*np.array(waves).swapaxes(0, 1)) for waves in both), default=nan)
