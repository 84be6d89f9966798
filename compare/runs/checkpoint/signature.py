"""Signature of a result: hashes of scene and program, library versions, number of processes."""

import hashlib
import json
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jointwave import cases
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.warnings import warnings
from jointwave.compare.engines import solver
from jointwave.results.dataset import scene_hash

Signature = dict[str, str]
PROCESSES = "number of processes"
#: Keys of [numerics.dem] that affect only the steps of rigid blocks, or no result at all.
DEM_STEPS = {"step_fraction", "scheme", "allow_unstable", "static_tolerance", "threads"}
#: Keys of [numerics] that do not affect the results of each engine.
INDIFFERENT = {
    "dem": {"dem": {"threads"}, "continuum": True},
    "continuum": {"dem": DEM_STEPS},
    "exact": {"dem": DEM_STEPS, "continuum": True},
}


def signature(scene: AnyScene, name: str, processes: int) -> Signature:
    """Return what must match for a run to be continued or its result to be reused.

    name : of the solver.
    """
    found = {package: version(package) for package in ("numpy", "numba")}
    record = scene.record.model_dump_json()
    return {
        "scene": _scene(scene, name),
        "[record] table": hashlib.sha256(record.encode()).hexdigest()[:16],
        "engine": name,
        PROCESSES: str(processes),
        "program": program(),
        "version of numpy, numba or dolfinx": json.dumps(found | solver(name).libraries()),
    }


def differences(one: Signature, other: Signature) -> list[str]:
    """Return the keys in which two signatures differ."""
    return [key for key in one if other.get(key) != one[key]]


@cache
def program() -> str:
    """Return a hash of the source files that affect results."""
    digest, root = hashlib.sha256(), Path(cases.__file__).parent.parent
    for package in ("cases", "results", "numerics", "joints", "dem", "continuum", "compare"):
        for source in sorted((root / package).rglob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()


def _scene(scene: AnyScene, name: str) -> str:
    """Return a hash of the keys but [record] that affect a solver's result, with the scene's
    warnings; the numerics of another engine and [expect] do not affect it."""
    left_out: dict[str, Any] = {"numerics": INDIFFERENT[solver(name).engine]}
    text = scene.model_dump_json(exclude=left_out | {"expect": True, "record": True})
    return scene_hash(scene, text + json.dumps(warnings(scene)))
