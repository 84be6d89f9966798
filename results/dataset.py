"""The common form of all results, whether from an engine or an exact solution."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.effects import active_effects
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.cases.warnings import warnings
from jointwave.results.labels import label

#: All terms of an energy ledger, and those of axial motion with joints that do not break.
ALL_TERMS = (
    "kinetic",
    "elastic",
    "viscous",
    "friction",
    "fracture",
    "boundary",
    "gravity",
    "work",
)
TERMS = ("kinetic", "elastic", "viscous", "boundary", "work")

#: Dimensions of each quantity except time, its receivers or the terms of the ledger first.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "stress": ("stress_y",),
    "shear": ("stress_y", "across"),
    "velocity": ("velocity_y", "axis"),
    "displacement": ("velocity_y", "axis"),
    "rotation": ("velocity_y", "axis"),
    "energy": ("term",),
}

A_RESULT = "a result: a Dataset, of `simulate` or a file"  # what functions accept
MOST_OPEN = 1e-3  # of a ledger's largest term, that no term may account for
#: Of the energy at rest, a billion times the round-off of double precision: soft joints let stiff
#: rock move as a whole by far more than it strains, and the last digits of that strain it, too.
AT_REST = 1e9 * float(np.finfo(float).eps)


def scene_hash(scene: AnyScene, text: str | None = None) -> str:
    """Return a short hash of everything that determines a result, including samples of loads and
    the file of a mesh or of blocks.

    text : the scene as JSON, where it is at hand.
    """
    digest = hashlib.sha256((text or scene.model_dump_json()).encode())
    for pulse in scene.pulses:
        if pulse.history is not None:
            digest.update(pulse.history.time.tobytes())
            digest.update(pulse.history.stress.tobytes())
    # An unreadable mesh is reported where it is used, with a message of its own.
    if scene.mesh_path is not None and scene.mesh_path.is_file():
        digest.update(scene.mesh_path.read_bytes())
    return digest.hexdigest()[:16]


def dataset(
    scene: Scene,
    engine: str,
    time: np.ndarray,
    stress: np.ndarray,
    velocity: np.ndarray,
    displacement: np.ndarray | None = None,
    energy: np.ndarray | None = None,
    shear: np.ndarray | None = None,
    rotation: np.ndarray | None = None,
    *,
    terms: Sequence[str] = TERMS,
    errors: Mapping[str, np.ndarray] | None = None,
    **attributes: Any,
) -> xr.Dataset:
    """Return the result of a pillar with the common schema of all engines and exact solutions.

    Parameters
    ----------
    engine : "dem", "continuum-jointed", ..., or the name of an exact solution.
    time : float array [n], s.
    stress : float array [len(record.stress), n], Pa, compression positive.
    velocity, displacement : float array [len(record.velocity), n], m/s and m, along y; of spatial
        motion [len(record.velocity), n, 3], along x, y, z.
    energy : float array [len(terms), n], J; work is the energy input of the load, the other terms
        its stored and dissipated parts.
    shear : float array [len(record.stress), n, 2], along x, z, the force on the far side over the
        area, Pa; for spatial motion only.
    rotation : float array [len(record.velocity), n, 3], about x, y, z, rad; likewise.
    terms : names of the rows of `energy`, from ALL_TERMS.
    errors : for a computed solution, an upper bound on the root-mean-square error over time
        of each waveform, by its quantity (a key of DIMENSIONS) and in its unit: float arrays of
        that quantity's shape without time. A closed form has none.
    attributes : numbers and texts about the run (dt, steps, seconds, ...).
    """
    record, spatial = scene.record, velocity.ndim == 3
    quantities = {
        "stress": stress,
        "velocity": _with_axis(velocity),
        "displacement": None if displacement is None else _with_axis(displacement),
        "shear": shear,
        "rotation": rotation,
        "energy": energy,
    }
    places = {"stress_y": record.stress, "velocity_y": record.velocity}
    coords = {name: ((name,), np.array(at, float)) for name, at in places.items()}
    components = {"axis": "xyz" if spatial else "y", "across": "xz", "term": terms}
    return assemble(
        {"time": (("time",), time), **coords},
        quantities,
        DIMENSIONS,
        components,
        errors or {},
        attributes_of(scene, engine, attributes),
    )


def assemble(
    coords: Mapping[str, tuple[tuple[str, ...], np.ndarray]],
    quantities: Mapping[str, np.ndarray | None],
    dimensions: Mapping[str, tuple[str, ...]],
    components: Mapping[str, Sequence[str]],
    errors: Mapping[str, np.ndarray],
    attributes: Mapping[str, Any],
) -> xr.Dataset:
    """Return a result of the quantities that are known, with the bounds of their errors.

    coords : times and receivers. dimensions : of each quantity except time, its receivers or terms
    first. components : names along the other dimensions.
    """
    variables, named = {}, dict(coords)
    for name, values in quantities.items():
        if values is not None:
            receivers, *others = dimensions[name]
            variables[name] = ((receivers, "time", *others), values)
            for one in set(components) & set(dimensions[name]):
                named[one] = ((one,), np.array(list(components[one])))
    for name, bound in errors.items():
        found = np.asarray(bound, dtype=float)
        found = found[:, None] if found.ndim < len(dimensions[name]) else found  # one axis
        variables[f"{name}_error"] = (dimensions[name], found)
    return xr.Dataset(labelled(variables), labelled(named), attributes)


def labelled(variables: Mapping[str, tuple]) -> dict[str, tuple]:
    """Return variables (dimensions, values) with their names and units for plots."""
    return {name: (*variable, label(name)) for name, variable in variables.items()}


def attributes_of(scene: AnyScene, engine: str, own: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of a result: its scene and solver, `own` attributes of the run, and the
    scene itself, last because of its length."""
    text = scene.model_dump_json()
    common = {
        "engine": engine,
        "kind": scene.kind,
        "title": scene.title,
        "variant": scene.name,
        "scene_hash": scene_hash(scene, text),
        **static_attributes(scene),
        "effects": json.dumps(active_effects(scene)),
        "warnings": json.dumps(warnings(scene)),
    }
    return {**common, **own, "scene": text}


def static_attributes(scene: AnyScene) -> dict[str, Any]:
    """Return the attributes of a result that describe its initial state.

    starts : "unloaded", "prestressed" or "at rest under gravity". prestress : in every section of a
    pillar, Pa, if any; in a rock mass the first sample is the initial state, from which
    displacement counts.
    """
    prestress = scene.prestress
    normal = getattr(prestress, "normal", None)
    pressed = {} if normal is None else {"prestress": normal}
    if scene.gravity is not None and scene.gravity.static:
        return {"starts": "at rest under gravity", **pressed}
    return {"starts": "unloaded" if prestress is None else "prestressed", **pressed}


def energy_residual(result: xr.Dataset) -> float:
    """Return the largest imbalance of a result's energy ledger over the largest work."""
    return imbalance(result["energy"].values, [str(term) for term in result["term"].values])


def imbalance(energy: np.ndarray, terms: Sequence[str] = TERMS) -> float:
    """Return the largest imbalance of an energy ledger [len(terms), n] over the largest work.

    Both are relative to the first sample, which includes the energy of a static state. Without
    work, as under gravity only, the largest term is used instead. If it is larger, `AT_REST` of the
    static state's energy is the denominator: round-off of the sums, tens of epsilon of that energy,
    reaches the work under a prestress of millions of times the load.
    """
    since = energy - energy[:, :1]
    work = since[list(terms).index("work")]
    balance = since.sum(axis=0) - 2 * work
    scale = float(np.abs(work if work.any() else since).max())
    scale = max(scale, AT_REST * float(np.abs(energy[:, 0]).max()))
    return float(np.abs(balance).max()) / scale if scale > 0 else 0.0


def open_ledger(result: xr.Dataset) -> str:
    """Return a warning of an energy ledger that is open by more than `MOST_OPEN` of its largest
    term; "" where it closes."""
    energy = result["energy"].values
    since = energy - energy[:, :1]
    work = since[result["term"].values.tolist().index("work")]
    left = float(np.abs(since.sum(axis=0) - 2 * work).max())
    scale = max(float(np.abs(since).max()), AT_REST * float(np.abs(energy[:, 0]).max()))
    if not left > MOST_OPEN * scale:
        return ""
    damps = result.attrs.get("scheme") == "implicit"
    why = "the damping of implicit steps, or steps too long" if damps else "steps too long"
    return (
        f"{result.attrs['engine']}: the energy ledger is open by {left / scale:.2g} of its largest "
        f"term, {scale:.3g} J: {why}"
    )


def _with_axis(values: np.ndarray) -> np.ndarray:
    """Return values [point, time, axis] of axial [point, time] or spatial motion."""
    return values if values.ndim == 3 else values[..., None]
