"""The run of rigid blocks, from first sample to result."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
import xarray as xr

from jointwave.cases.errors import StoppedError
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.numerics.divergence import ENERGY, Guard
from jointwave.numerics.instability import Divergence, stopped
from jointwave.numerics.time_loop import Checkpointer, run_in_chunks
from jointwave.results.snapshots import SnapshotRecorder

BLOCK_STEPS_AT_ONCE = 20_000_000  # some 10 ms to 1 s: often enough for a progress bar
ENOUGH_BLOCKS = {1: 200_000, 2: 40_000, 3: 10_000}  # by dimension: from there on threads pay
LOOKS = 20  # at a run, at least: blocks may move further than they can
LEAST_STEPS = 64  # at least: each thread copies its blocks before and after


class Run(NamedTuple):
    """A run: its clock, how many blocks it has, and what takes its samples.

    march : of (first, last), takes samples first .. last - 1. check : of the same, raises an error
    if the run exceeds its bounds then. parts : its state.
    """

    time: Clock
    blocks: int
    march: Callable[[int, int], None]
    check: Callable[[int, int], None]
    parts: Any


def followed(
    run: Run,
    result: Callable[[int], xr.Dataset],
    progress: Callable[[float], None] | None,
    recorder: SnapshotRecorder | None,
    keeper: Checkpointer | None,
) -> xr.Dataset:
    """Return the result of a run; if it stops early, the error has the valid part. result : a
    function of the number of valid samples."""

    def march(first: int, last: int) -> None:
        if recorder is not None:
            recorder.record_if_due(first)
        run.march(first, last)
        run.check(first, last)

    steps = min(BLOCK_STEPS_AT_ONCE // run.blocks, run.time.steps // LOOKS)
    chunk = max(LEAST_STEPS, steps) // run.time.stride
    try:
        run_in_chunks(run.time.samples, chunk, march, run.parts, progress, recorder, keeper)
    except StoppedError as error:
        error.result = result(error.samples)
        raise
    return result(run.time.samples)


def refuse_beyond_bounds(
    scene: AnyScene,
    time: Clock,
    critical: float,
    guard: Guard,
    speed: np.ndarray,
    places: np.ndarray,
) -> None:
    """Raise StoppedError for a run that a guard has found out of its bounds.

    critical : step, s. speed : of each block [N], in any unit. places : of the blocks, y [N], or x
    and y [N, 2], m.
    """
    step, what, sound = guard.found.tolist()
    at = places[int(np.nan_to_num(speed, nan=np.inf).argmax())].tolist()
    place = tuple(at) if isinstance(at, list) else at
    key = "numerics.dem.step_fraction"
    seen = Divergence("the rigid blocks", key, step, sound, what == ENERGY, place)
    raise stopped(scene, time, critical, seen)


def thread_count(asked: int | None, blocks: int, dim: int) -> int:
    """Return the threads to use: as requested, or one for few blocks and all cores for many."""
    if asked is not None:
        return asked
    return _cores() if blocks >= ENOUGH_BLOCKS[dim] else 1


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def versions() -> str:
    """Return what the engine runs on, as JSON."""
    return json.dumps({"numpy": np.__version__, "numba": numba.__version__})
