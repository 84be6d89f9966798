"""The order in which tiles take their steps, on one thread or several.

A tile needs its left neighbour's last joint at the same step and its right neighbour's first
block at the step before. So a tile may run ahead of its right neighbour by nothing and behind its
left neighbour by one: the tiles t, t - 1, t - 2, ... take the steps n, n + 1, n + 2, ... while
they are in the cache, and several threads follow one another along the row, each some steps
later. Every block does the same arithmetic in whatever order, so results are bit-identical.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np

from dem.spatial.energy import close_ledger
from dem.spatial.layout import Form
from dem.spatial.model import Buffers, RowModel, RowSamples, RowState
from dem.spatial.step import step_for
from numerics.atomic import give_way, peek, post
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.divergence import Guard, creates_energy
from numerics.jit import jitted_for

RUN = 16  # diagonals of tiles between two checks of the others' progress


@cache
def march_for(form: Form) -> Callable:
    """Return the kernel that takes steps of rows with these effects."""
    step = step_for(form)
    ledger = form.ledger

    def march(
        constants, blocks, table, points, stress, direction, base, ends, contacts, centres, places,
        stride, motion, history, sliding, end_states, sums, force, velocity, displacement, energy,
        buffers, carry, ledgers, depth, limit, peak, found, progress, thread, first, last,
    ):  # fmt: skip
        """Take this thread's share of the steps first .. last - 1, in turn with the others.

        Band B of `depth` steps belongs to thread B modulo their number. It enters a run of
        diagonals of tiles, tile k - j at step j of the band, when band B - 1 has left the next
        run: what it reads is finished then, and what it writes nobody reads any more.

        progress : int64 [threads + 1], zero at first: B runs + r when r runs of band B are left
        behind, for each thread, and how many bands have closed their ledgers. The rest are the
        arrays of `dem.spatial.model`, None for what the form does not have.
        """
        tiny = flush_tiny()
        model = borrowed((constants, table, points, stress, direction, base, ends))
        state = borrowed((motion, history, sliding, end_states))
        recorded = borrowed((contacts, centres, force, velocity, displacement))
        tiles, threads = len(motion), progress.size - 1
        runs = (tiles + depth - 1 + RUN - 1) // RUN
        for band in range(thread, (last - first + depth - 1) // depth, threads):
            n = first + band * depth
            steps, slot = min(depth, last - n), thread * depth
            for run in range(runs):
                if band > 0:
                    finished = (band - 1) * runs + min(run + 2, runs)
                    while peek(progress, (band - 1) % threads) < finished:
                        give_way()
                if found[0] < 0:
                    for k in range(run * RUN, min((run + 1) * RUN, tiles + steps - 1)):
                        for j in range(max(0, k - tiles + 1), min(steps, k + 1)):
                            own = None
                            if ledger:
                                own = ledgers[slot + j]
                            step(
                                model, state, recorded, buffers[thread], carry[slot + j], own,
                                blocks, k - j, n + j, stride, limit, found,
                            )  # fmt: skip
                post(progress, thread, band * runs + run + 1)
            while peek(progress, threads) < band:
                give_way()
            if ledger:
                for j in range(n, n + steps):
                    sampled, sample = j % stride == 0, j // stride
                    close_ledger(ledgers[slot + j - n], sums, energy, places, sampled, sample)
                    if sampled and limit is not None:
                        creates_energy(Guard(limit, peak, found), energy, sample, j)
            post(progress, threads, band + 1)
        restore_tiny(tiny)

    return jitted_for(form)(march)


def marcher(
    model: RowModel, state: RowState, buffers: Buffers, samples: RowSamples
) -> Callable[[int, int], None]:
    """Return a function that takes the steps first .. last - 1 on the threads of the buffers."""
    kernel, threads = march_for(model.form), len(buffers.tile)

    def march(first: int, last: int) -> None:
        progress = np.zeros(threads + 1, dtype=np.int64)

        def share(thread: int) -> None:
            kernel(*arguments(model, state, buffers, samples, progress), thread, first, last)

        if threads == 1 or first == last:  # nothing to take: compiles
            share(0)
            return
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(share, range(threads)))

    return march


def arguments(
    model: RowModel, state: RowState, buffers: Buffers, samples: RowSamples, progress: np.ndarray
) -> tuple:
    """Return what a kernel takes but for its thread and steps."""
    guard = buffers.guard or (None, None, np.array([-1, 0, -1]))  # no limit, nothing found
    return (
        model.block.as_array(), model.block_count, model.table, model.points, *model.load,
        model.ends, *model.receivers, model.places, model.stride, *state, *samples,
        *buffers[:-1], *guard, progress,
    )  # fmt: skip
