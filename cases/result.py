"""The one form of every result, whichever engine or formula it comes from."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cases.effects import active_effects
from cases.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

TERMS = ("kinetic", "elastic", "viscous", "boundary", "work")


Variable = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]


class Fields(NamedTuple):
    """A result as plain arrays, in the order that xarray.Dataset takes them.

    variables, coords : name to (dimensions, values, attributes). attributes : of the whole.
    xarray takes longer to import than most scenes to run; what needs no Dataset uses this.
    """

    variables: dict[str, Variable]
    coords: dict[str, Variable]
    attributes: dict[str, Any]


def scene_hash(scene: Scene) -> str:
    """Return a short hash of everything that decides a result, the load's samples included."""
    digest = hashlib.sha256(scene.model_dump_json().encode())
    if scene.load.history is not None:
        digest.update(scene.load.history.time.tobytes())
        digest.update(scene.load.history.stress.tobytes())
    return digest.hexdigest()[:16]


def dataset(*arguments: Any, **attributes: Any) -> xr.Dataset:
    """Return a result as xarray.Dataset; takes what `fields` takes."""
    import xarray as xr

    return xr.Dataset(*fields(*arguments, **attributes))


def fields(
    scene: Scene,
    engine: str,
    time: np.ndarray,
    stress: np.ndarray,
    velocity: np.ndarray,
    displacement: np.ndarray | None = None,
    energy: np.ndarray | None = None,
    **attributes: Any,
) -> Fields:
    """Return a result with the schema that all engines and exact solutions share.

    Parameters
    ----------
    engine : "dem", "continuum-jointed", ..., or the name of an exact solution.
    time : float array [n], s.
    stress : float array [len(record.stress), n], Pa, compression positive.
    velocity, displacement : float array [len(record.velocity), n], m/s and m, along y.
    energy : float array [len(TERMS), n], J; work is what the load has put in, the others
        what became of it.
    attributes : numbers and texts about the run (dt, steps, seconds, ...).
    """
    points = ("velocity_y", "time", "axis")
    variables: dict[str, Variable] = {
        "stress": (("stress_y", "time"), stress, {"units": "Pa"}),
        "velocity": (points, velocity[..., None], {"units": "m/s"}),
    }
    record = scene.record
    coords: dict[str, Variable] = {
        "time": (("time",), time, {"units": "s"}),
        "stress_y": (("stress_y",), np.array(record.stress, dtype=float), {"units": "m"}),
        "velocity_y": (("velocity_y",), np.array(record.velocity, dtype=float), {"units": "m"}),
        "axis": (("axis",), np.array(["y"]), {}),
    }
    if displacement is not None:
        variables["displacement"] = (points, displacement[..., None], {"units": "m"})
    if energy is not None:
        variables["energy"] = (("term", "time"), energy, {"units": "J"})
        coords["term"] = (("term",), np.array(TERMS), {})
    common = {
        "engine": engine,
        "title": scene.title,
        "variant": scene.name,
        "scene": scene.model_dump_json(),
        "scene_hash": scene_hash(scene),
        "effects": json.dumps(active_effects(scene)),
    }
    return Fields(variables, coords, {**common, **attributes})


def energy_residual(result: xr.Dataset) -> float:
    """Return the largest imbalance of a result's energy ledger over the largest work put in."""
    return imbalance(result["energy"].values)


def imbalance(energy: np.ndarray) -> float:
    """Return the largest imbalance of an energy ledger [len(TERMS), n] over the largest work."""
    work = energy[TERMS.index("work")]
    balance = energy.sum(axis=0) - 2 * work
    scale = float(np.abs(work).max())
    return float(np.abs(balance).max()) / scale if scale > 0 else 0.0
