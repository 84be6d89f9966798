"""What steps have cost here, by what decides their cost; of each what was measured last.

Kept beside the kernels, so that what another state of the program took is not taken for this one's.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from time import perf_counter
from typing import Any

import numba

import numerics.jit  # noqa: F401  it says where the kernels are
from cases.effects import active_effects
from cases.files import read_json
from cases.schema.scene import Scene
from compare.engines import ENGINES
from compare.runs.output import write_text
from results.dataset import scene_hash

LARGEST_FILE = 10_000_000  # bytes
SHORTEST = 0.01  # s: what is over sooner tells too little to replace what is known
CHANGED = 2.0  # a rate that has changed by this factor is written anew


def note(name: str, scene: Scene, about: Mapping[str, Any], seconds: float | None = None) -> None:
    """Remember what a run has cost.

    about : its attributes. seconds : that it took in all, which is what exact solutions cost.
    """
    if name in ENGINES:
        count, spent = about["steps"] * units(name, scene, about), float(about["seconds_stepping"])
        key = _key(name, scene, about)
        if count and (spent > SHORTEST or key not in _known()):
            _keep(key, spent / count)
    elif seconds is not None:
        _keep(f"{name} {scene_hash(scene)}", seconds)


def note_block_step(scene: Scene, nanoseconds: float, threads: int = 1) -> None:
    """Remember what a step of one rigid block costs."""
    _keep(_key("dem", scene, {"threads": threads}), 1e-9 * nanoseconds)


def block_step(scene: Scene) -> float | None:
    """Return what a step of one rigid block took, ns; None where none such was ever timed."""
    rate = _known().get(_key("dem", scene, {"threads": 1}))
    return None if rate is None else 1e9 * rate


def stepping(name: str, scene: Scene, about: Mapping[str, Any]) -> float | None:
    """Return the seconds that a run's steps should take; None where none such was ever timed.

    about : as `compare.experiments.cost.run_cost` knows it: steps, degrees_of_freedom, scheme, ...
    """
    if name not in ENGINES:
        return _known().get(f"{name} {scene_hash(scene)}")
    rate = _known().get(_key(name, scene, about))
    return None if rate is None else rate * about["steps"] * units(name, scene, about)


def units(name: str, scene: Scene, about: Mapping[str, Any]) -> float:
    """Return what a step's cost is counted in: blocks, or freedoms of the rock."""
    return scene.pillar.block_count if name == "dem" else about["degrees_of_freedom"]


def note_whole(what: str, seconds: float) -> None:
    """Remember what a whole command took, or one point of it."""
    _keep(f"whole {what}", seconds)


@contextmanager
def timing(what: str, count: int) -> Iterator[None]:
    """Remember what one of so many points took, in the mean; nothing where there are none."""
    began = perf_counter()
    yield
    if count:
        note_whole(what, (perf_counter() - began) / count)


def whole(what: str) -> float | None:
    """Return what that took the last time; None where it was never done here."""
    return _known().get(f"whole {what}")


def _key(name: str, scene: Scene, about: Mapping[str, Any]) -> str:
    effects = " ".join(sorted(active_effects(scene)))
    if name == "dem":
        return f"dem {scene.numerics.dem.scheme} {about['threads']} {effects}"
    return " ".join(str(x) for x in (name, *(about[k] for k in OF_ROCK), effects))


OF_ROCK = ("scheme", "dim", "cell", "order", "processes")


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
    with suppress(OSError):  # a cache that cannot be written costs estimates only
        write_text(_file(), json.dumps({**known, key: value}))


def _file() -> Path:
    return Path(numba.config.CACHE_DIR) / "rates.json"
