"""Leapfrog steps of rigid blocks: the order in which tiles take their steps.

A tile needs the forces of the contacts of the tile before it at the same step, and the blocks of
the next one at the step before. So the tiles t, t - 1, t - 2, ... take the steps n, n + 1, n + 2,
... while they are in the cache, and several threads follow one another through the rock mass, each
some steps later. Every block does the same arithmetic in whatever order, so results are
bit-identical for any number of threads.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.chunks import LANES, depth_of, marks
from jointwave.dem.kernel import step_for
from jointwave.dem.model import KernelFlags, Model, Samples, State
from jointwave.dem.motion import AFTER, SUMMED
from jointwave.dem.rotation import free_motion
from jointwave.numerics.atomic import give_way, peek, post
from jointwave.numerics.borrowed import borrowed
from jointwave.numerics.cache_lines import zeros
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted


class ChunkTable(NamedTuple):
    """Contacts as the kernel takes them: as in `chunks.Chunks`, the table of the laws, the
    first chunk, block, held block, recorded block and watched contact of each tile [5, tiles + 1],
    places and rows of watched contacts [2, w], and how many contacts there are."""

    pair: np.ndarray
    table: np.ndarray
    row_from: np.ndarray
    laws: np.ndarray
    tiles: np.ndarray
    seen: np.ndarray
    contacts: int


class BlockTable(NamedTuple):
    """Blocks as the kernel takes them: `model.Blocks`, with one over the inertia of each freedom,
    numbers, matrices and springs of held blocks, places and rows of recorded ones [2, r], `back`,
    the inverse of the tensor, and `free`, as `rotation.free_motion` has it."""

    inertia: np.ndarray
    inverse: np.ndarray
    held: Any
    matrices: Any
    springs: Any
    places: np.ndarray
    gravity: np.ndarray
    tensor: Any
    back: Any
    free: Any
    dt: float
    keep: float
    local: float
    stages: Any


def march(
    model: Model,
    state: State,
    samples: Samples,
    stride: int,
    steps: tuple[int, int],
    drive: np.ndarray | None = None,
    shake: np.ndarray | None = None,
    threads: int = 1,
) -> None:
    """Take the steps first .. last - 1, with their samples, `stride` steps apart.

    drive : float array [last - first, h, freedoms], N and N m, forces on held blocks in each step;
    [(last - first) stages, ...] in each stage of composed steps, at `composition.instants`.
    shake : float array [last - first, walls, dim], the velocity of walls in each step, m/s.
    """
    take = make_stepper(model, state, samples, steps[1] - steps[0], drive, shake, threads)
    take(stride, *steps)


def make_stepper(
    model: Model,
    state: State,
    samples: Samples,
    most: int,
    drive: np.ndarray | None = None,
    shake: np.ndarray | None = None,
    threads: int = 1,
) -> Callable[..., None]:
    """Return a function of (stride, first, last) that does what `march` does, as often as it is
    called, and at most so many steps at a time.

    drive, shake : of the first of the steps on, as they are then. The function may be given what
    mass-proportional damping leaves of a velocity in a step, `keep`, in place of the model's.
    """
    form, chunks, f = model.form, model.chunks, model.form.freedoms
    own, dt, stages = model.blocks, model.blocks.dt, form.stages
    held, matrices, springs = model.held or (None, None, None)
    if held is None:
        drive = None  # one kernel, whoever asks
    elif drive is None:
        drive = np.zeros((stages * most, len(held), f))
    walls = None if shake is None else motion_of_walls(state, shake, dt)
    bands = -(-stages * most // depth_of(chunks, state.history, f, threads))
    bands = max(1, bands + -bands % threads)  # as many for each thread
    depth = max(1, -(-stages * most // bands))
    widest = f * int(np.diff(chunks.first_block).max())
    buffers = zeros((threads, form.buffer.before + widest))
    ledgers = zeros((threads * depth, 2 * AFTER)) if form.ledger else None
    progress = np.zeros(threads + 1, dtype=np.int64)
    loop, inertia = loop_for(form), model.inertia.ravel()
    force = np.zeros(inertia.size)
    first_place, places = marks(model.places, chunks.first_block)
    first_seen, seen = marks(chunks.place[model.watched], LANES * chunks.first_chunk)
    first_held = np.searchsorted(np.zeros(0) if held is None else held, chunks.first_block)
    tiles = np.stack([chunks.first_chunk, chunks.first_block, first_held, first_place, first_seen])
    between = ChunkTable(
        chunks.pair, chunks.table, chunks.row_from, model.laws, tiles, seen,
        len(chunks.place),
    )  # fmt: skip
    blocks = BlockTable(
        inertia, 1.0 / inertia, held, matrices, springs, places, own.gravity, own.tensor,
        None if own.tensor is None else np.linalg.inv(own.tensor),
        free_motion(own) if form.finite else None, dt, own.keep, own.local, own.stages,
    )  # fmt: skip
    flat = state._replace(u=state.u.reshape(-1), v=state.v.reshape(-1))

    def take(stride: int, first: int, last: int, keep: float = own.keep) -> None:
        count = last - first
        if count > most:
            raise ValueError(f"{count} steps at a time, at most {most}")
        progress[:] = 0
        if walls is not None and shake is not None:
            walls[: count + 1] = motion_of_walls(state, shake[:count], dt)
        damped = blocks._replace(keep=keep)

        def share(thread: int) -> None:
            span = (thread, stages * first, stages * last, stages * stride, depth)
            work = (force, buffers[thread], ledgers, progress)
            loop(between, damped, flat, samples, drive, walls, work, span)

        if threads == 1 or first == last:  # nothing to take: compiles
            share(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(share, range(threads)))
        if walls is not None:
            u, v = walls[count].reshape(2, -1, f)[:, 1:]
            state.u[-model.walls :], state.v[-model.walls :] = u, v

    return take


def motion_of_walls(state: State, shake: np.ndarray, dt: float) -> np.ndarray:
    """Return displacement and velocity of walls that move as `shake` says [steps + 1, 2,
    freedoms (1 + walls)], before each step and after the last, none at first."""
    (steps, walls, dim), f = shake.shape, state.u.shape[1]
    found = np.zeros((steps + 1, 2, 1 + walls, f))
    found[0, :, 1:] = state.u[-walls:], state.v[-walls:]
    found[1:, 1, 1:, :dim] = shake
    found[1:, 0, 1:, :dim] = dt * shake
    found[:, 0] = found[:, 0].cumsum(axis=0)
    return found.reshape(steps + 1, 2, -1)


def widths_of(form: KernelFlags) -> tuple[int, ...]:
    """Return how many lanes of each term of the ledger there are, 0 of terms that are absent."""
    parts, held, lanes = form.parts, int(form.held), LANES
    damped = int(form.mass_damping or form.local_damping)
    return (
        1, lanes, lanes if parts.dashpots else damped, lanes * (form.points > 0 and form.dim > 1),
        lanes * parts.softening, held, int(form.gravity), lanes if form.shaken else held,
    )  # fmt: skip


@cache
def loop_for(form: KernelFlags) -> Callable:
    """Return the time loop of blocks with these effects; absent ones are not compiled."""
    step, has_ledger, widths = step_for(form), form.ledger, widths_of(form)

    @jitted
    def loop(chunks, blocks, state, samples, drive, walls, work, span):
        """Take this thread's share of the steps first .. last - 1, in turn with the others.

        Band B of `depth` steps belongs to thread B modulo their number; its diagonal k has tile
        k - j at its step j. It enters one when band B - 1 has left the one that asks for the last
        of its own steps at the next tile.

        work : forces, zero, buffers, ledgers, and the diagonals that each thread has left behind,
        as many for each band, with how many bands have closed their ledgers. span : thread, first,
        last, stride, depth.
        """
        setting = flush_denormals()
        chunks, blocks, state = borrowed(chunks), borrowed(blocks), borrowed(state)
        samples, drive, walls = borrowed(samples), borrowed(drive), borrowed(walls)
        force, buffer, ledgers, progress = borrowed(work)
        thread, first, last, stride, depth = span
        tiles, threads, ledger = chunks.tiles.shape[1] - 1, progress.size - 1, None
        diagonals = tiles + depth - 1
        for band in range(thread, (last - first + depth - 1) // depth, threads):
            n = first + band * depth
            steps = depth if depth < last - n else last - n
            for k in range(tiles + steps - 1):
                if band > 0:
                    ahead = k + depth + 1 if k + depth + 1 < diagonals else diagonals
                    while peek(progress, (band - 1) % threads) < (band - 1) * diagonals + ahead:
                        give_way()
                from_step = k - tiles + 1 if k >= tiles else 0
                for j in range(from_step, steps if steps < k + 1 else k + 1):
                    if has_ledger:
                        ledger = ledgers[thread * depth + j]
                    s = (n + j) // stride if (n + j) % stride == 0 else -1
                    step(
                        chunks, blocks, state, force, drive, walls, samples, buffer, ledger,
                        k - j, n + j - first, s,
                    )  # fmt: skip
                post(progress, thread, band * diagonals + k + 1)
            while peek(progress, threads) < band:
                give_way()
            if has_ledger:
                for j in range(n, n + steps):
                    one = ledgers[thread * depth + j - n]
                    for term in range(state.sums.size):
                        begin, before, after = term * LANES, 0.0, 0.0
                        sampled, summed = j % stride == 0, begin in SUMMED
                        end = begin + (widths[term] if sampled or summed else 0)
                        for i in range(begin, end):  # always in this order
                            before, after = before + one[i], after + one[AFTER + i]
                            one[i], one[AFTER + i] = 0.0, 0.0
                        if sampled:
                            samples.energy[term, j // stride] = state.sums[term] + before
                        if summed:
                            state.sums[term] += before + after
            post(progress, threads, band + 1)
        restore_denormals(setting)

    return loop
