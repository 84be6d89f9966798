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

from jointwave.dem.spatial.layout import (
    AFTER,
    BUFFER,
    CARRY,
    FRICTION,
    KINETIC,
    LANES,
    LEDGER,
    TERMS,
    KernelFlags,
)
from jointwave.dem.spatial.leapfrog import step_for
from jointwave.dem.spatial.model import Buffers, RowModel, RowSamples, RowState
from jointwave.joints.formula import formula
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.atomic import give_way, peek, post
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.divergence import ENERGY, EVERY, gains_energy, note
from jointwave.numerics.jit import jitted

PLACES = tuple(TERMS.values())
RUN = 16  # diagonals of tiles between two checks of the others' progress


@cache
def march_for(form: KernelFlags) -> Callable:
    """Return the kernel that takes steps of rows with these effects."""
    step = step_for(form)
    has_ledger = form.ledger

    @formula
    def diagonals(
        constants, counts, table, points, drive, ends, places, motion, history, end_states,
        force, speed, displacement, buffer, ledgers, thread, begin, end, n, steps, limit, found,
    ):  # fmt: skip
        """Take the steps n .. n + steps - 1 on the diagonals begin .. end - 1."""
        tiles, depth, ledger = counts[1], counts[7], None
        for k in range(begin, end):
            from_step = k - tiles + 1 if k >= tiles else 0
            for j in range(from_step, steps if steps < k + 1 else k + 1):
                if has_ledger:
                    ledger = ledgers[thread * depth + j]
                step(
                    constants, counts, table, points, drive, ends, places, motion,
                    history, end_states, force, speed, displacement, buffer,
                    BUFFER + CARRY * j, ledger, k - j, n + j, limit, found,
                )  # fmt: skip

    def march(given, thread, first, last):
        """Take this thread's share of the steps first .. last - 1, in turn with the others.

        Band B of `depth` steps belongs to thread B modulo their number. It enters a run of
        diagonals of tiles, tile k - j at step j of the band, when band B - 1 has left the next
        run: what it reads is finished then, and what it writes nobody reads any more.

        given : of `arguments`. progress : B runs + r when r runs of band B are left behind, for
        each thread, and how many bands have closed their ledgers.
        """
        setting = flush_denormals()
        (
            counts, constants, table, points, drive, ends, places, motion, history, end_states,
            sums, force, speed, displacement, energy, tile, ledgers, limit, peak, found, progress,
        ) = unpacked(given)  # fmt: skip
        tiles, stride, depth, threads = counts[1], counts[2], counts[7], progress.size - 1
        buffer = tile[thread]
        runs = (tiles + depth - 1 + RUN - 1) // RUN
        for band in range(thread, (last - first + depth - 1) // depth, threads):
            n = first + band * depth
            steps = depth if depth < last - n else last - n
            for run in range(runs):
                if band > 0:
                    ahead = run + 2 if run + 2 < runs else runs
                    while peek(progress, (band - 1) % threads) < (band - 1) * runs + ahead:
                        give_way()
                if found[0] < 0:
                    most = tiles + steps - 1
                    most = most if most < (run + 1) * RUN else (run + 1) * RUN
                    diagonals(
                        constants, counts, table, points, drive, ends, places, motion, history,
                        end_states, force, speed, displacement, buffer, ledgers, thread,
                        run * RUN, most, n, steps, limit, found,
                    )  # fmt: skip
                post(progress, thread, band * runs + run + 1)
            while peek(progress, threads) < band:
                give_way()
            if has_ledger:
                for j in range(n, n + steps):
                    one, s = ledgers[thread * depth + j - n], j // stride
                    for i in range(AFTER):
                        sums[i] += one[i]
                    if j % stride == 0:
                        for k in range(energy.shape[0]):  # unrolled if it were a constant
                            total = 0.0
                            for i in range(PLACES[k], PLACES[k] + LANES):  # always in this order
                                total += one[i] if i >= KINETIC else sums[i]
                            energy[k, s] = total
                        if limit is not None and gains_energy(peak, energy, s):
                            note(found, j, ENERGY, j - EVERY - 1)
                    for i in range(FRICTION):
                        sums[i] += one[AFTER + i]
                    for i in range(LEDGER):
                        one[i] = 0.0
            post(progress, threads, band + 1)
        restore_denormals(setting)

    return jitted(march)


def make_stepper(
    model: RowModel, state: RowState, buffers: Buffers, samples: RowSamples
) -> Callable[[int, int], None]:
    """Return a function that takes the steps first .. last - 1 on the threads of the buffers."""
    kernel, threads = march_for(model.form), len(buffers.tile)
    progress = np.zeros(threads + 1, dtype=np.int64)
    given = arguments(model, state, buffers, samples, progress)

    def march(first: int, last: int) -> None:
        progress[:] = 0
        if threads == 1 or first == last:  # nothing to take: compiles
            kernel(given, 0, first, last)
            return
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(lambda thread: kernel(given, thread, first, last), range(threads)))

    return march


def arguments(
    model: RowModel, state: RowState, buffers: Buffers, samples: RowSamples, progress: np.ndarray
) -> Packed:
    """Return what a kernel is given but for its thread and steps: the arrays of
    `dem.spatial.model`, None for what the form does not have.

    progress : int64 [threads + 1], zero before each march. The first of the arrays has counts, of
    blocks, tiles, steps from a sample to the next, contacts among the receivers, receivers, points
    of a face, steps of the load, depth, freedoms of a block, ends: numbers that are given, since
    loops over constants are unrolled.
    """
    (stress, direction, base), receivers = model.load, model.receivers
    drive, places = stress if base is None else base, np.hstack(receivers)
    counts = (
        model.block_count, len(state.motion), model.stride, receivers.contacts.shape[1],
        places.shape[1], model.points.shape[1], drive.size, buffers.depth, model.form.freedoms, 2,
    )  # fmt: skip
    limit, peak, found = None, np.zeros(1), np.array([-1, 0, -1])  # no limit, nothing found
    if buffers.guard is not None:
        limit, peak, found = buffers.guard
        limit = limit.view(np.float64)
    return Packed(
        np.array(counts), model.block.as_array(direction), model.table, model.points, drive,
        model.ends, places, *state, *samples,
        *buffers[:2], limit, peak, found, progress, distinct=True,
    )  # fmt: skip
