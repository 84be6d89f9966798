"""Rates measured on this machine: the seconds of a step of one block or freedom, by kind of run.

They are saved beside the compiled kernels, so that rates of other versions of the program are not
used. `--dry-run` estimates the time of runs by them.
"""

import json
import os
import platform
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from jointwave.cases.effects import active_effects
from jointwave.cases.files import read_json
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES
from jointwave.compare.runs.output import write_text
from jointwave.compare.runs.processes import started
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Prepared
from jointwave.numerics import jit
from jointwave.results.dataset import scene_hash

LARGEST_FILE = 10_000_000  # bytes
SHORTEST = 0.01  # s: shorter runs do not replace a known rate
CHANGED = 2.0  # a rate that has changed by this factor is rewritten


def note(
    name: str, scene: AnyScene, about: Mapping[str, Any], seconds: float | None = None
) -> None:
    """Store the rate of a run.

    about : attributes of its result. seconds : in total, used for exact solutions.
    """
    if name not in ENGINES:
        if seconds is not None:
            _keep(_of_exact(name, scene), seconds)
        return
    units = ENGINES[name].units(scene, about["degrees_of_freedom"])
    count, spent = about["steps"] * units, float(about["seconds_stepping"])
    key = _key(name, scene, about)
    if count and (spent > SHORTEST or key not in _known()):
        _keep(key, spent / count)


def stepping(name: str, scene: AnyScene, run: Prepared) -> float | None:
    """Return the expected seconds of a run's steps; None if no such run was ever timed here."""
    if name not in ENGINES:
        return _known().get(_of_exact(name, scene))
    rate = _known().get(_key(name, scene, {"processes": started().size, **run.settings}))
    return None if rate is None else rate * run.steps * ENGINES[name].units(scene, run.freedoms)


def block_step(scene: AnyScene) -> float | None:
    """Return the measured cost of a step of one rigid block of a pillar, ns; None if unknown."""
    settings = {"scheme": scene.numerics.dem.scheme, "threads": 1}  # type: ignore[union-attr]
    rate = _known().get(_key(DEM.name, scene, settings))
    return None if rate is None else 1e9 * rate


def _key(name: str, scene: AnyScene, about: Mapping[str, Any]) -> str:
    settings = (about[key] for key in ENGINES[name].cost)
    return " ".join(map(str, (name, *settings, scene.kind, *sorted(active_effects(scene)))))


def _of_exact(name: str, scene: AnyScene) -> str:
    return f"{name} {scene_hash(scene)}"


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
    import numpy

    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": numpy.__version__,
        "numba": numba.__version__,
    }


def measured_on() -> str:
    """Return the machine in words."""
    about = machine()
    return f"{about['processor']}, {about['cores']} cores, numba {about['numba']}"


def processor() -> str:
    """Return the processor's name."""
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
