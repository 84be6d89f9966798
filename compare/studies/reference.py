"""What errors are measured against: exact solutions, or fine runs whose own error is bounded."""

import math
from typing import Any, NamedTuple

import xarray as xr

from cases.result import scene_hash
from cases.scene import Scene
from cases.tables import Numerics
from compare.engines import solve
from compare.metrics import misfit, relative_l2
from compare.studies.study import Reference, Study


class Error(NamedTuple):
    """A misfit, and the floor below which it is not known: 0 against an exact solution."""

    misfit: float
    floor: float


UNKNOWN = Error(math.nan, math.nan)


def error(
    result: xr.Dataset, against: str | Reference | None, study: Study, physics: dict[str, Any]
) -> Error:
    """Return the error of a result of the study's scene with some physics changed; unknown
    without anything to measure it against."""
    if against is None:
        return UNKNOWN
    if isinstance(against, str):
        exact = reference(against, study.changed(physics))
        return Error(_misfit(result, exact, study), 0.0)
    changes = physics | against.changes
    fine = _solved(against.method, study.changed(changes))
    coarse = _solved(against.method, study.changed(changes | against.coarser))
    return Error(_misfit(result, fine, study), _misfit(coarse, fine, study))


def reference(name: str, scene: Scene) -> xr.Dataset:
    """Return an exact solution, whatever the scene's numerics; solved once a process."""
    return _solved(name, scene.model_copy(update={"numerics": Numerics(), "expect": {}}))


def _solved(name: str, scene: Scene) -> xr.Dataset:
    key = name, scene_hash(scene)
    if key not in _known:
        _known[key] = solve(name, scene)
    return _known[key]


_known: dict[tuple[str, str], xr.Dataset] = {}


def _misfit(one: xr.Dataset, other: xr.Dataset, study: Study) -> float:
    if study.quantity is None:
        return misfit(one, other)
    return relative_l2(one[study.quantity].values, other[study.quantity].values)
