"""The common form of rock-mass results, whether from an engine or an exact solution."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.results.dataset import assemble, attributes_of

#: Dimensions of each quantity except time, its receivers or the terms of the ledger first.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "velocity": ("point", "axis"),
    "displacement": ("point", "axis"),
    "stress": ("point", "stress_component"),
    "traction": ("joint_point", "joint_axis"),
    "gap": ("joint_point",),
    "slip": ("joint_point",),
    "energy": ("term",),
}
#: Names of the components of a quantity.
COMPONENTS = {
    "axis": ("x", "y"),
    "stress_component": ("xx", "yy", "xy"),
    "joint_axis": ("n", "s"),
}
#: Terms of the energy ledger.
TERMS = (
    "kinetic", "elastic", "viscous", "friction", "fracture", "boundary", "gravity", "work",
)  # fmt: skip


def plane_dataset(
    scene: RockMass,
    engine: str,
    time: np.ndarray,
    quantities: Mapping[str, np.ndarray],
    energy: np.ndarray | None = None,
    terms: Sequence[str] = TERMS,
    errors: Mapping[str, np.ndarray] | None = None,
    **attributes: Any,
) -> xr.Dataset:
    """Return a result with the common schema of all solutions of rock masses.

    Parameters
    ----------
    engine : "dem", "continuum-jointed", ..., or the name of an exact solution.
    time : float array [n], s.
    quantities : by name, those that the solver knows: float arrays with the `DIMENSIONS` and
        time after the receivers. velocity, displacement [points, n, 2], m/s and m; stress
        [points, n, 3], Pa, compression positive, the mean over the block or that of the element;
        traction [joints, n, 2], Pa, compression and shear along the joint; gap, slip [joints, n],
        m. Displacement, gap and slip are relative to the state at the start of the run.
    energy : float array [len(terms), n], J per metre of thickness; work is the energy input
        of loads and waves, the other terms its stored and dissipated parts.
    errors : for a computed solution, an upper bound on the root-mean-square error over time
        of each waveform, by quantity: float arrays of its shape without time.
    attributes : numbers and texts about the run (dt, steps, seconds, ...).

    Joint receivers are identified by their places in [record]; the tangent of a joint is its
    normal, out of the block with the smaller number, rotated to the left.
    """
    coords: dict[str, tuple[tuple[str, ...], np.ndarray]] = {"time": (("time",), time)}
    for name, places in (("point", scene.record.points), ("joint_point", scene.record.joints)):
        at = np.array(places, dtype=float).reshape(-1, 2)
        coords[name] = ((name,), np.arange(len(at), dtype=np.int32))
        coords |= {f"{name}_{axis}": ((name,), at[:, k]) for k, axis in enumerate("xy")}
    found = assemble(
        coords,
        {**quantities, "energy": energy},
        DIMENSIONS,
        COMPONENTS | {"term": tuple(terms)},
        errors or {},
        attributes_of(scene, engine, attributes),
    )
    if energy is not None:
        found["energy"].attrs["units"] = "J/m"  # of thickness
    return found
