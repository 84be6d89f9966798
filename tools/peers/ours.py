"""The same pillar in jointwave, run as a user does: `jointwave run` in a separate process."""

import json
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from job import Job, Reading, Twin, folder_of
from pillar import pillar

from jointwave import cases
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import solve
from jointwave.compare.runs.output import write
from jointwave.compare.scenes import find
from jointwave.results.dataset import scene_hash

#: A blow so close to the axis that blocks do not rotate, but all six freedoms are computed.
IN_SPACE = {"load.at": [1e-12, 0.0]}
SCENE = "guo-li-2002/fig-03"
ALIKE = {"record.energy": False}  # no peer computes an energy ledger
#: There is no exact solution of the square column: jointwave at order 4, within 1 % of order 3.
COLUMN = "continuum-equivalent in space, order 4"
IN_COLUMN = "continuum: the homogenised column in space, 3 freedoms a node"


class Kind(NamedTuple):
    """A model of jointwave: its curve, words, engine, exact solution, and changes of the scene."""

    curve: str
    solves: str
    engine: str
    reference: str
    changes: dict


def _continuum(dim: int, order: int) -> dict:
    numerics = {"dim": dim, "order": order, "scheme": "explicit"}
    return {f"numerics.continuum.{key}": value for key, value in numerics.items()}


KINDS = {
    "blocks along the axis": Kind(
        "jointwave blocks", "rigid blocks, 1 freedom each", "dem", "lattice", {}
    ),
    "blocks in space": Kind(
        "jointwave blocks in space", "rigid blocks, 6 freedoms each", "dem", "lattice", IN_SPACE
    ),
    "homogenised bar": Kind(
        *("jointwave bar", "continuum: the homogenised bar, 1 freedom a node"),
        *("continuum-equivalent", "equivalent-bar", _continuum(1, 1)),
    ),
    "homogenised column": Kind(
        "jointwave hexahedra", IN_COLUMN, "continuum-equivalent", COLUMN, _continuum(3, 1)
    ),
    "homogenised column, order 2": Kind(
        *("jointwave hexahedra of order 2", IN_COLUMN),
        *("continuum-equivalent", COLUMN, _continuum(3, 2)),
    ),
    "jointed bar": Kind(
        *("jointwave jointed bar", "continuum: intact rock and every joint, 1 freedom a node"),
        *("continuum-jointed", "jointed-bar", _continuum(1, 2)),
    ),
}

#: Runs without a peer: higher order, and jointed rock.
ALONE = (
    Twin("homogenised column, order 2", 2, 1),
    Twin("jointed bar", 4, 1),
    Twin("jointed bar", 8, 2),
)


def job(scene: Scene, twin: Twin, root: Path) -> Job:
    """Return the run of a jointwave model with the twin's step."""
    kind, p = KINDS[twin.model], pillar(scene, twin.stride)
    elements = {"elements_per_block": twin.elements} if twin.elements else {}
    settings = {**elements, "stride": twin.stride}
    critical, freedoms = _critical(twin.model, twin.elements)
    engine, _, model = kind.engine.partition("-")
    step = {f"numerics.{engine}.step_fraction": p.dt / critical * (1 + 1e-9)}  # not below it
    folder = folder_of(root, kind.curve, **settings)
    options = ["--variant", "", "--engine", engine, "--out", str(folder)]
    options += ["--model", model] if model else []
    for key, value in (_changes(twin.model, twin.elements) | step).items():
        options += ["--set", f"{key}={json.dumps(value)}"]
    return Job(
        curve=kind.curve,
        solves=kind.solves,
        reference=kind.reference,
        settings=settings,
        freedoms=freedoms,
        steps=p.steps,
        samples=p.samples,
        folder=folder,
        command=[sys.executable, "-m", "jointwave", "run", str(find(SCENE)), *options],
        read=lambda place: read(place, kind.engine),
    )


def read(folder: Path, engine: str) -> Reading:
    """Read the result file of a run."""
    with xr.open_dataset(folder / f"{engine}.nc") as found:
        return Reading(found["stress"].values[0], float(found.attrs["seconds_stepping"]))


def _changes(model: str, elements: int) -> dict:
    changes = {**ALIKE, **KINDS[model].changes}
    if elements:
        changes["numerics.continuum.elements_per_block"] = elements
    if changes.get("numerics.continuum.dim") == 3:
        changes["numerics.continuum.elements_across"] = elements
    return changes


@cache
def _critical(model: str, elements: int) -> tuple[float, int]:
    """Return the critical step (s) and the number of freedoms, from a run of one sample."""
    changes = _changes(model, elements) | {"time.duration": 5e-5, "expect": {}}
    found = solve(KINDS[model].engine, cases.load_variant(find(SCENE), "", changes))
    return float(found.attrs["critical_dt"]), int(found.attrs["degrees_of_freedom"])


def references(scene: Scene, root: Path) -> dict[str, np.ndarray]:
    """Return the reference waveforms by name; that of the column is saved for later runs."""
    names = {kind.reference for kind in KINDS.values()} - {COLUMN}
    found = {name: solve(name, scene)["stress"].values[0] for name in sorted(names)}
    return found | {COLUMN: _column(root / f"column-{scene_hash(scene)}.txt")}


def _column(kept: Path) -> np.ndarray:
    if not kept.exists():
        numerics = {"elements_per_block": 1, "step_fraction": 0.5}
        changes = {f"numerics.continuum.{key}": value for key, value in numerics.items()}
        fine = cases.load_variant(find(SCENE), "", {**ALIKE, **_continuum(3, 4), **changes})
        stress = solve("continuum-equivalent", fine)["stress"].values[0]
        write(kept, lambda path: np.savetxt(path, stress, fmt="%.17g"))
    return np.loadtxt(kept)
