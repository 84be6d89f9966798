"""The common form of rock-mass results, whether from an engine or an exact solution."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.results.dataset import ALL_TERMS, assemble, attributes_of
from jointwave.results.labels import AXES
from jointwave.results.stress import stress_components

#: Dimensions of each quantity except time, its receivers or the terms of the ledger first.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "velocity": ("point", "axis"),
    "displacement": ("point", "axis"),
    "stress": ("point", "stress_component"),
    "traction": ("joint_point", "joint_axis"),
    "gap": ("joint_point",),
    "slip": ("joint_point", "slip_axis"),
    "energy": ("term",),
}
#: Axes of a joint, the normal first, by the number of dimensions.
JOINT_AXES = {2: ("n", "s"), 3: ("n", "strike", "dip")}
#: Terms of the energy ledger.
TERMS = ALL_TERMS


def rock_mass_dataset(
    scene: RockMass,
    engine: str,
    time: np.ndarray,
    quantities: Mapping[str, np.ndarray],
    energy: np.ndarray | None = None,
    terms: Sequence[str] = TERMS,
    errors: Mapping[str, np.ndarray] | None = None,
    **attributes: Any,
) -> xr.Dataset:
    """Return a result with the common schema of all solutions of rock masses, in d dimensions.

    Parameters
    ----------
    engine : "dem", "continuum-jointed", ..., or the name of an exact solution.
    time : float array [n], s.
    quantities : by name, those that the solver knows: float arrays with the `DIMENSIONS` and
        time after the receivers. velocity, displacement [points, n, d], m/s and m; stress
        [points, n, 3 or 6], Pa, compression positive, the mean over the block or that of the
        element; traction [joints, n, d], Pa, compression and shear along the joint; gap [joints,
        n], m; slip [joints, n], in space [joints, n, 2], m. Displacement, gap and slip are relative
        to the state at the start of the run.
    energy : float array [len(terms), n], J, in the plane per metre of thickness; work is the energy
        input of loads and waves, the other terms its stored and dissipated parts.
    errors : for a computed solution, an upper bound on the root-mean-square error over time
        of each waveform, by quantity: float arrays of its shape without time.
    attributes : numbers and texts about the run (dt, steps, seconds, ...).

    Joint receivers are identified by their places in [record]. Traction acts on the side that the
    joint's normal points into, whose motion relative to the other side is gap and slip. The tangent
    is the normal rotated to the left. In space the normal points up (of a vertical joint to the
    north, or else east), and the tangents are the strike, horizontal, and the line of dip, upwards,
    in a right-handed frame with it.
    """
    dim = scene.domain.dimension
    coords: dict[str, tuple[tuple[str, ...], np.ndarray]] = {"time": (("time",), time)}
    for name, places in (("point", scene.record.points), ("joint_point", scene.record.joints)):
        at = np.array(places, dtype=float).reshape(-1, dim)
        coords[name] = ((name,), np.arange(len(at), dtype=np.int32))
        coords |= {f"{name}_{axis}": ((name,), at[:, k]) for k, axis in enumerate(AXES[:dim])}
    components = {
        "axis": AXES[:dim],
        "stress_component": tuple(stress_components(dim)),
        "joint_axis": JOINT_AXES[dim],
        "slip_axis": JOINT_AXES[dim][1:],
        "term": tuple(terms),
    }
    found = assemble(
        coords,
        {**quantities, "energy": energy},
        DIMENSIONS | ({"slip": ("joint_point",)} if dim == 2 else {}),
        components,
        errors or {},
        attributes_of(scene, engine, attributes),
    )
    if energy is not None and dim == 2:
        found["energy"].attrs["units"] = "J/m"  # of thickness
    return found
