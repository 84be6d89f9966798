"""The one form of every result, whichever engine or formula it comes from."""

import hashlib
import json
from typing import Any

import numpy as np
import xarray as xr

from cases.effects import active_effects
from cases.scene import Scene

TERMS = ("kinetic", "elastic", "viscous", "boundary", "work")


def scene_hash(scene: Scene) -> str:
    """Return a short hash of everything that decides a result, the load's samples included."""
    digest = hashlib.sha256(scene.model_dump_json().encode())
    if scene.load.history is not None:
        digest.update(scene.load.history.time.tobytes())
        digest.update(scene.load.history.stress.tobytes())
    return digest.hexdigest()[:16]


def dataset(
    scene: Scene,
    engine: str,
    time: np.ndarray,
    stress: np.ndarray,
    velocity: np.ndarray,
    displacement: np.ndarray | None = None,
    energy: np.ndarray | None = None,
    **attributes: Any,
) -> xr.Dataset:
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
    variables: dict[str, Any] = {
        "stress": (("stress_y", "time"), stress, {"units": "Pa"}),
        "velocity": (points, velocity[..., None], {"units": "m/s"}),
    }
    coords: dict[str, Any] = {
        "time": ("time", time, {"units": "s"}),
        "stress_y": ("stress_y", np.array(scene.record.stress, dtype=float), {"units": "m"}),
        "velocity_y": ("velocity_y", np.array(scene.record.velocity, dtype=float), {"units": "m"}),
        "axis": ("axis", ["y"]),
    }
    if displacement is not None:
        variables["displacement"] = (points, displacement[..., None], {"units": "m"})
    if energy is not None:
        variables["energy"] = (("term", "time"), energy, {"units": "J"})
        coords["term"] = ("term", list(TERMS))
    common = {
        "engine": engine,
        "title": scene.title,
        "variant": scene.name,
        "scene": scene.model_dump_json(),
        "scene_hash": scene_hash(scene),
        "effects": json.dumps(active_effects(scene)),
    }
    return xr.Dataset(variables, coords, {**common, **attributes})


def energy_residual(result: xr.Dataset) -> float:
    """Return the largest imbalance of the energy ledger over the largest work put in."""
    energy = result["energy"]
    work = energy.sel(term="work")
    balance = energy.drop_sel(term="work").sum("term") - work
    scale = float(np.abs(work).max())
    return float(np.abs(balance).max()) / scale if scale > 0 else 0.0
