"""The common form of the results of engines and exact solutions."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.effects import active_effects
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.warnings import warnings
from jointwave.results.labels import RECEIVERS, label
from jointwave.results.stress import stress_components

#: Terms of an energy ledger.
TERMS = ("kinetic", "elastic", "viscous", "friction", "fracture", "boundary", "gravity", "work")

OF_SECTIONS, OF_JOINTS = ("stress", "shear"), ("traction", "gap", "slip")
#: The dimension of the receivers of each key of [record].
RECEIVERS_OF = dict(zip(("stress", "velocity", "points", "joints"), RECEIVERS, strict=True))
#: The dimension of the components of each quantity, and the names of components.
COMPONENTS = {
    "stress": "stress_component",
    "shear": "across",
    **dict.fromkeys(("velocity", "displacement", "rotation"), "axis"),
    "traction": "joint_axis",
    "slip": "slip_axis",
}
NAMES: dict[str, dict[int, Sequence[str]]] = {
    "stress_component": {len(of): tuple(of) for of in map(stress_components, (2, 3))},
    "across": {2: "xz"},
    "axis": {1: "y", 2: "xy", 3: "xyz"},
    "joint_axis": {2: ("n", "s"), 3: ("n", "strike", "dip")},
    "slip_axis": {2: ("strike", "dip")},
}

Coordinates = dict[str, tuple[tuple[str, ...], np.ndarray]]
A_RESULT = "a result: a Dataset, of `simulate` or a file"  # what functions accept
MOST_OPEN = 1e-3  # largest imbalance of a ledger, over its largest term
#: Least scale of an imbalance, over the static energy; 1e9 times round-off: soft joints let stiff
#: rock move as a whole far more than it strains, and round-off of this motion strains it.
AT_REST = 1e9 * float(np.finfo(float).eps)


def scene_hash(scene: AnyScene, text: str | None = None) -> str:
    """Return a short hash of everything that determines a result, including samples of loads and
    the file of a mesh or of blocks; text : the scene as JSON, if known."""
    digest = hashlib.sha256((text or scene.model_dump_json()).encode())
    for pulse in scene.pulses:
        if pulse.history is not None:
            digest.update(pulse.history.time.tobytes())
            digest.update(pulse.history.stress.tobytes())
    # An unreadable mesh is reported where it is used.
    if scene.mesh_path is not None and scene.mesh_path.is_file():
        digest.update(scene.mesh_path.read_bytes())
    return digest.hexdigest()[:16]


def dataset(
    scene: AnyScene,
    engine: str,
    time: np.ndarray,
    quantities: Mapping[str, np.ndarray],
    energy: np.ndarray | None = None,
    terms: Sequence[str] = TERMS,
    errors: Mapping[str, np.ndarray] | None = None,
    **attributes: Any,
) -> xr.Dataset:
    """Return a result with the common schema of all engines and exact solutions.

    engine : "dem", "continuum-jointed", ..., or the name of an exact solution.
    time : float array [n], s.
    quantities : by name, float arrays in SI, stress and traction compression positive.
        Pillar: stress [sections, n]; velocity, displacement [points, n], along y.
        Pillar in space: velocity, displacement, rotation [points, n, 3], along or about x, y, z;
        shear [sections, n, 2], along x, z, the force on the far side over the area.
        Rock mass in d dimensions: velocity, displacement [points, n, d]; stress [points, n, 3 or
        6], the mean over the block, or of the element; traction [joints, n, d], compression and
        shear along the joint; gap [joints, n]; slip [joints, n], in space [joints, n, 2].
        Displacement, gap and slip are relative to the state at the start of the run.
    energy : float array [len(terms), n], J, in the plane per metre of thickness; work is the energy
        input of loads and waves, the other terms its stored and dissipated parts.
    terms : names of the rows of `energy`, from TERMS.
    errors : of a computed solution, upper bounds on the root-mean-square error over time of each
        waveform, by quantity, in its unit and in its shape without time. A closed form has none.
    attributes : numbers and texts about the run (dt, steps, seconds, ...).

    Joint receivers are identified by their places in [record]. Traction acts on the side into which
    the joint's normal points; gap and slip are the motion of this side relative to the other. In
    the plane the tangent is the normal rotated to the left. In space the normal points up (of a
    vertical joint to the north, or else east); the tangents are the horizontal strike and the line
    of dip, upwards, in a right-handed frame.
    """
    coords, variables = _receivers(scene) | {"time": (("time",), time)}, {}
    for name, values in quantities.items():
        dims, found = _variable(scene, name, ("time",), values)
        variables[name] = dims, found
        for one in dims[2:]:
            coords[one] = (one,), np.array([*NAMES[one][found.shape[2]]])
    for name, bound in (errors or {}).items():
        variables[f"{name}_error"] = _variable(scene, name, (), np.asarray(bound, dtype=float))
    if energy is not None:
        variables["energy"] = ("term", "time"), energy
        coords["term"] = ("term",), np.array(terms)
    about = attributes_of(scene, engine, attributes)
    result = xr.Dataset(labelled(variables), labelled(coords), about)
    if energy is not None and scene.in_plane:
        result["energy"].attrs["units"] = "J/m"  # of thickness
    return result


def _receivers(scene: AnyScene) -> Coordinates:
    """Return the coordinates of the receivers."""
    found: Coordinates = {}
    for key, at in scene.places.items():
        name = RECEIVERS_OF[key]
        found[name] = (name,), np.arange(len(at), dtype=np.int32)  # unless places identify them
        found |= {x: ((name,), of) for x, of in zip(RECEIVERS[name], at.T, strict=False)}
    return found


def key_of(quantity: str, axes: int) -> str:
    """Return the key of [record] that lists the receivers of a quantity; axes : number of their
    coordinates."""
    if axes == 1:
        return "stress" if quantity in OF_SECTIONS else "velocity"
    return "joints" if quantity in OF_JOINTS else "points"


def _variable(
    scene: AnyScene, name: str, time: tuple[str, ...], values: np.ndarray
) -> tuple[tuple[str, ...], np.ndarray]:
    """Return a quantity and its dimensions: receivers, time, and components if it has several;
    motion along one axis gets a dimension of one component."""
    receivers = RECEIVERS_OF[key_of(name, len(scene.axes))]
    dims = (receivers, *time, COMPONENTS.get(name, ""))
    if dims[-1] == "axis" and values.ndim < len(dims):
        values = values[..., None]
    return dims[: values.ndim], values


def labelled(variables: Mapping[str, tuple]) -> dict[str, tuple]:
    """Return variables (dimensions, values) with long names and units as attributes."""
    return {name: (*variable, label(name)) for name, variable in variables.items()}


def attributes_of(scene: AnyScene, engine: str, own: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of a result: scene, solver, initial state, `own` attributes of the run,
    and the scene as JSON, last because of its length.

    folder : of a file of blocks or a mesh, if any. starts : "unloaded", "prestressed" or "at rest
    under gravity". peak_load : the largest stress of a load or wave, Pa, unless from a file.
    prestress : in every section of a pillar, Pa, if any; in a rock mass it is in
    the stress of the first sample.
    """
    text, pressed = scene.model_dump_json(), getattr(scene.prestress, "normal", None)
    starts = "unloaded" if scene.prestress is None else "prestressed"
    if scene.gravity is not None and scene.gravity.static:
        starts = "at rest under gravity"
    file = getattr(getattr(scene, "domain", None), "mesh_path", None)
    given = [one for one in scene.pulses if "stress" in one.quantity and one.file is None]
    return {
        "engine": engine,
        "kind": scene.kind,
        "title": scene.title,
        "variant": scene.name,
        "scene_hash": scene_hash(scene, text),
        "starts": starts,
        "peak_load": max((abs(one.amplitude) for one in given), default=0.0),
        **({} if file is None else {"folder": str(file.resolve().parent)}),
        **({} if pressed is None else {"prestress": pressed}),
        "effects": json.dumps(active_effects(scene)),
        "warnings": json.dumps(warnings(scene)),
        **own,
        "scene": text,
    }


def energy_residual(result: xr.Dataset) -> float:
    """Return the largest imbalance of a result's energy ledger over the largest work."""
    return imbalance(result["energy"].values, result["term"].values.tolist())


def imbalance(energy: np.ndarray, terms: Sequence[str]) -> float:
    """Return the largest imbalance of an energy ledger [len(terms), n] over the largest work.

    Both are changes since the first sample, which has the energy of a static state. Without work,
    as under gravity only, the largest term replaces it. The denominator is at least `AT_REST` times
    the static energy: under a prestress of millions of times the load, round-off of the sums, tens
    of epsilon of the static energy, is as large as the work.
    """
    left, work, largest, least = _ledger(energy, terms)
    scale = max(work or largest, least)
    return left / scale if scale > 0 else 0.0


def _ledger(energy: np.ndarray, terms: Sequence[str]) -> tuple[float, float, float, float]:
    """Return the largest imbalance, work and term since the first sample, and the least energy that
    round-off of the static energy leaves meaningful, J."""
    since = energy - energy[:, :1]
    work = since[list(terms).index("work")]
    parts = since.sum(axis=0) - 2 * work, work, since, AT_REST * energy[:, 0]
    left, most, largest, least = (float(np.abs(x).max()) for x in parts)
    return left, most, largest, least


def open_ledger(result: xr.Dataset) -> str:
    """Return a warning if the imbalance exceeds `MOST_OPEN` of the largest term, else ""."""
    left, _, largest, least = _ledger(result["energy"].values, result["term"].values.tolist())
    scale = max(largest, least)
    if not left > MOST_OPEN * scale:
        return ""
    damps = result.attrs.get("scheme") == "implicit"
    why = "the damping of implicit steps, or steps too long" if damps else "steps too long"
    return (
        f"{result.attrs['engine']}: the energy ledger is open by {left / scale:.2g} of its largest "
        f"term, {scale:.3g} J: {why}"
    )
