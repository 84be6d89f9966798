"""References of errors: exact solutions, or fine runs whose own error is bounded."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from cases.kinds import AnyScene
from compare.engines import ENGINES, EXACT, applies, solve, solver
from compare.experiments.common import ErrorReference
from compare.experiments.study.methods import METHODS
from compare.experiments.study.study import FINEST, NONE, FineRun, Study, StudyPoint
from compare.misfit.metrics import Pairing, pairings, relative_l2, worst
from compare.misfit.ranking import applicable, finest, own_exact
from results.dataset import scene_hash


class Error(NamedTuple):
    """A misfit, and its floor, below which it is not known: 0 against a closed form."""

    misfit: float
    floor: float


UNKNOWN = Error(math.nan, math.nan)


def finest_of(study: Study) -> str | FineRun | None:
    """Return the reference of total errors: as set by the study, else the finest exact solution;
    None if the finest that applies is an engine and the study gives no fine run of it."""
    if study.finest is not None:
        return None if study.finest == NONE else study.finest
    key = study.model_dump_json()
    if key not in _finest:
        scene = study.base
        found = finest([name for name, answer in applicable(scene).items() if answer], scene)
        _finest[key] = None if found is None or found.name in ENGINES else found.name
    return _finest[key]


def own_of(point: StudyPoint) -> str | FineRun | None:
    """Return the reference of a point's numerical error: as set by its curve, else the exact
    solution of its own model, else a run of its engine as fine as the study's; None without."""
    own, study = point.curve.own, point.study
    if own is not None:
        return finest_of(study) if own == FINEST else None if own == NONE else own
    scene, method = point.scene, point.curve.method
    engine = METHODS[method].ENGINE if method in METHODS else method
    exact = own_exact(engine, [n for n in EXACT if applies(n, scene)], scene)
    return exact or _as_fine(engine, study.finest)


def _as_fine(engine: str, finest: str | FineRun | None) -> FineRun | None:
    """Return the run of an engine with the numerics of a fine run, if they apply to it."""
    if not isinstance(finest, FineRun):
        return None
    alike = solver(engine).engine == solver(finest.method).engine
    return finest.model_copy(update={"method": engine}) if alike else None


def known(
    against: str | FineRun | None, study: Study, physics: dict[str, Any]
) -> ErrorReference | None:
    """Return a reference of the study's scene with some physics changed; None without."""
    if against is None:
        return None
    if isinstance(against, str):
        return reference(against, study.changed(physics))
    changes = physics | against.changes
    fine = _solved(against.method, study.changed(changes))
    coarse = _solved(against.method, study.changed(changes | against.coarser))
    return ErrorReference(against.method, fine, _misfit(coarse, fine, study), str(against.changes))


def error(result: xr.Dataset, against: ErrorReference | None, study: Study) -> Error:
    """Return the error of a result, over the quantity of the study; 0 of a reference itself,
    unknown without one."""
    if against is None:
        return UNKNOWN
    if result is against.result:
        return Error(0.0, 0.0)
    return Error(_misfit(result, against.result, study), against.error)


def reference(name: str, scene: AnyScene) -> ErrorReference:
    """Return an exact solution, regardless of the scene's numerics; solved once per process."""
    scene = scene.model_copy(update={"numerics": type(scene.numerics)(), "expect": {}})
    key = name, scene_hash(scene)
    if key not in _references:
        exact = _solved(name, scene)
        _references[key] = ErrorReference(name, exact, worst(exact, exact).floor)
    return _references[key]


def _solved(name: str, scene: AnyScene) -> xr.Dataset:
    key = name, scene_hash(scene)
    if key not in _known:
        _known[key] = solve(name, scene)
    return _known[key]


_known: dict[tuple[str, str], xr.Dataset] = {}
_references: dict[tuple[str, str], ErrorReference] = {}
_finest: dict[str, str | None] = {}  # by the study's text


def _misfit(one: xr.Dataset, other: xr.Dataset, study: Study) -> float:
    """Return the misfit of the worst waveform; for a single quantity, the relative L2 norm over
    time and all its receivers, of the worst component."""
    if study.quantity is None:
        return worst(one, other).misfit
    found = [p for p in pairings(one, other) if p.place.quantity == study.quantity]
    by_component: dict[str, list[Pairing]] = {}
    for one_pair in found:
        by_component.setdefault(one_pair.place.component, []).append(one_pair)
    return max((_norm(pairs) for pairs in by_component.values()), default=math.nan)


def _norm(pairs: list[Pairing]) -> float:
    return relative_l2(np.array([p.one for p in pairs]), np.array([p.other for p in pairs]))
