"""How many threads a row of blocks is worth, and how they share its steps."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from dem.spatial.model import Model, Room, Samples, State
from dem.spatial.step import march, march_in_turn

WORTH_IT = 20_000  # blocks from which a second thread gains more than following the first costs


def thread_count(asked: int | None, blocks: int) -> int:
    """Return the threads to use: as asked, or one for a short row and all cores for a long one."""
    if asked is not None:
        return asked
    return _cores() if blocks >= WORTH_IT else 1


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def marcher(model: Model, state: State, room: Room, samples: Samples) -> Callable[[int, int], None]:
    """Return a function that takes the steps first .. last - 1 on the threads of a room."""
    threads = len(room.scratch)
    if threads == 1:
        return lambda first, last: march(model, state, room, samples, first, last)

    def march_together(first: int, last: int) -> None:
        progress = np.zeros(threads + 1, dtype=np.int64)

        def share(thread: int) -> None:
            march_in_turn(model, state, room, samples, first, last, thread, progress)

        if first == last:
            share(0)  # compiles
            return
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(share, range(threads)))

    return march_together
