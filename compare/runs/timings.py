"""Rates measured on this machine, for the estimates of `--dry-run`: seconds per step and block or
freedom, by kind of run; per byte of waveforms of exact solutions; of set-up before the first step;
and of the other tasks of a command.

They are saved with the compiled kernels, so that other versions of the program do not use them.
"""

import json
import os
import platform
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, TypeVar

import xarray as xr

from jointwave.cases.effects import active_effects
from jointwave.cases.files import read_json
from jointwave.cases.run_memory import waveform_bytes
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress, solve
from jointwave.compare.runs.output import write_text
from jointwave.compare.runs.processes import started
from jointwave.compare.solvers.record import Prepared
from jointwave.numerics import jit
from jointwave.results.dataset import scene_hash

T = TypeVar("T")

LARGEST_FILE = 10_000_000  # bytes
SHORTEST = 0.01  # s; shorter runs do not replace a known rate
CHANGED = 1.2  # factor of change above which a rate is rewritten
#: Default seconds of each task, if it was never timed on this machine.
OTHERWISE = {
    "exact": 0.3,  # per solution
    "kernels": 3.0,  # compiling, per kind of run
    "explicit": 2e-8,  # per step and block or freedom, also for schemes not listed
    "implicit": 5e-7,
    "blocks": 5e-6,  # per snapshot and block
    "freedoms": 3e-7,
    "blocks for ParaView": 1.7e-5,  # with snapshots as files
    "freedoms for ParaView": 2.3e-6,
    "processes": 1.5,  # start with imports
    "diagrams": 4.0,  # of a study or of effects
    "frames": 0.05,  # of an animation
    "figures": 1.0,  # per variant, like all below
    "distances": 0.5,
    "tables": 1.5,  # of `compare --out`, with its figure
    "pages": 2.5,  # of a report
}


def timed(work: Callable[[], T]) -> tuple[T, float, float]:
    """Return the result of some work, its wall time, s, and the fraction of it in which this
    process ran, less than 1 if others compute at the same time."""
    wall, cpu = perf_counter(), process_time()
    result = work()
    wall, cpu = perf_counter() - wall, process_time() - cpu
    return result, wall, min(1.0, cpu / wall)


def solved(
    name: str, scene: AnyScene, progress: Progress | None = None
) -> tuple[xr.Dataset, float]:
    """Return the result of an engine or exact solution and its seconds, and store its rate."""
    result, seconds, part = timed(partial(solve, name, scene, progress))
    note(name, scene, result.attrs, seconds, part)
    return result, seconds


def note(
    name: str,
    scene: AnyScene,
    about: Mapping[str, Any],
    seconds: float | None = None,
    part: float = 1.0,
) -> None:
    """Store the rate of a run, unless it takes snapshots, and its set-up time.

    about : attributes of its result. seconds : total, or None. part : of seconds, see `timed`.
    """
    seconds = None if seconds is None else part * seconds
    if name not in ENGINES:
        if seconds is not None:
            _keep(_of_scene(name, scene), seconds)
            _keep(_key(name, scene, {}), seconds / waveform_bytes(scene))
        return
    units = ENGINES[name].units(scene, about["degrees_of_freedom"])
    count, spent = about["steps"] * units, part * float(about["seconds_stepping"])
    key = _key(name, scene, about)
    if count and (spent > SHORTEST or key not in _known()) and scene.record.fields is None:
        _keep(key, spent / count)
    if seconds is not None:
        _keep(_of_scene(name, scene), seconds - spent - part * float(about["seconds_compile"]))


def setup(name: str, scene: AnyScene) -> float | None:
    """Return the set-up seconds of this run before its first step; None if never timed."""
    return _known().get(_of_scene(name, scene)) if name in ENGINES else 0.0


def stepping(name: str, scene: AnyScene, run: Prepared) -> float | None:
    """Return the expected seconds of stepping without snapshots; None if never timed."""
    if name not in ENGINES:
        rate = _known().get(_key(name, scene, {}))
        likely = None if rate is None else rate * waveform_bytes(scene)
        return _known().get(_of_scene(name, scene), likely)
    rate = _known().get(_key(name, scene, {"processes": started().size, **run.settings}))
    return None if rate is None else rate * run.steps * ENGINES[name].units(scene, run.freedoms)


@contextmanager
def measured(what: str, kind: str, count: float = 1) -> Iterator[None]:
    """Store the CPU seconds of the context per task, for `count` tasks; kind : of the scene."""
    began = process_time()
    yield
    _keep(f"{what} {kind}", (process_time() - began) / count)


def each(what: str, kind: str) -> float:
    """Return the seconds of a task of `OTHERWISE`, as last timed on this machine."""
    return _known().get(f"{what} {kind}", OTHERWISE[what])


def _key(name: str, scene: AnyScene, about: Mapping[str, Any]) -> str:
    settings = (about[key] for key in (ENGINES[name].cost if name in ENGINES else ()))
    effects = sorted({*active_effects(scene)} - {"field output"})
    return " ".join(map(str, (name, *settings, scene.kind, *effects)))


def _of_scene(name: str, scene: AnyScene) -> str:
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


def processor() -> str:
    """Return the processor's name."""
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
