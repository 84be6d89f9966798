"""Rates measured on this machine: last seconds per step, per point, per command.

They are saved beside the kernels, so that those of other versions of the program are not used.
"""

import json
import os
import platform
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from cases.effects import active_effects
from cases.files import read_json
from cases.kinds import AnyScene
from cases.schema.scene import Scene
from compare.engines import ENGINES
from compare.runs.output import write_text
from compare.runs.processes import started
from compare.solvers.dem import DEM
from numerics import jit
from results.dataset import scene_hash

LARGEST_FILE = 10_000_000  # bytes
SHORTEST = 0.01  # s: shorter runs do not replace a known rate
CHANGED = 2.0  # a rate that has changed by this factor is rewritten


def note(
    name: str, scene: AnyScene, about: Mapping[str, Any], seconds: float | None = None
) -> None:
    """Store the cost of a run.

    about : its attributes. seconds : in total, used for exact solutions.
    """
    if name in ENGINES:
        units = ENGINES[name].units(scene, about["degrees_of_freedom"])
        count, spent = about["steps"] * units, float(about["seconds_stepping"])
        key = _key(name, scene, about)
        if count and (spent > SHORTEST or key not in _known()):
            _keep(key, spent / count)
    elif seconds is not None:
        _keep(f"{name} {scene_hash(scene)}", seconds)


def note_block_step(scene: Scene, nanoseconds: float, threads: int = 1) -> None:
    """Store the cost of a step of one rigid block."""
    _keep(_of_blocks(scene, threads), 1e-9 * nanoseconds)


def block_step(scene: Scene) -> float | None:
    """Return the measured cost of a step of one rigid block, ns; None if never timed."""
    rate = _known().get(_of_blocks(scene, 1))
    return None if rate is None else 1e9 * rate


def stepping(
    name: str, scene: AnyScene, settings: Mapping[str, Any], steps: int, freedoms: int
) -> float | None:
    """Return the expected seconds of a run's steps; None if no such run was ever timed.

    settings : those that determine the cost of a step, see `compare.solvers.record.Prepared`.
    """
    if name not in ENGINES:
        return _known().get(f"{name} {scene_hash(scene)}")
    rate = _known().get(_key(name, scene, {"processes": started().size, **settings}))
    return None if rate is None else rate * steps * ENGINES[name].units(scene, freedoms)


def note_whole(what: str, seconds: float) -> None:
    """Store the time of a whole command, or of one point of it."""
    _keep(f"whole {what}", seconds)


@contextmanager
def timing(what: str, count: int) -> Iterator[None]:
    """Store the mean time per point; nothing without points."""
    began = perf_counter()
    yield
    if count:
        note_whole(what, (perf_counter() - began) / count)


def whole(what: str) -> float | None:
    """Return the last stored time; None if there is none on this machine."""
    return _known().get(f"whole {what}")


def _key(name: str, scene: AnyScene, about: Mapping[str, Any]) -> str:
    kind = [] if isinstance(scene, Scene) else [scene.kind]
    effects = " ".join(kind + sorted(active_effects(scene)))
    return " ".join(str(x) for x in (name, *(about[k] for k in ENGINES[name].cost), effects))


def _of_blocks(scene: Scene, threads: int) -> str:
    return _key(DEM.name, scene, {"scheme": scene.numerics.dem.scheme, "threads": threads})


def _known() -> dict[str, float]:
    try:
        return {str(key): float(value) for key, value in read_json(_file(), LARGEST_FILE).items()}
    except (ValueError, TypeError, AttributeError):
        return {}


def _keep(key: str, value: float) -> None:
    known = _known()
    old = known.get(key)
    if old is not None and old / CHANGED < value < old * CHANGED:
        return
    with suppress(OSError):  # without a writable cache only estimates are lost
        write_text(_file(), json.dumps({**known, key: value}))


def _file() -> Path:
    return jit.DIRECTORY / "rates.json"


def machine() -> dict[str, str]:
    """Return the properties of the machine on which timings depend."""
    import numba

    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def measured_on() -> str:
    """Return the machine in words."""
    about = machine()
    return f"{about['processor']}, {about['cores']} cores, numba {about['numba']}"


def processor() -> str:
    """Return the processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
