"""Leapfrog steps of rigid blocks: the order in which tiles take their steps.

A tile needs the forces of the contacts of the tile before it at the same step, and the blocks of
the next one at the step before. So the tiles t, t - 1, t - 2, ... take the steps n, n + 1, n + 2,
... while they are in the cache. Threads have parts of the tiles, as `dem.kernel.parts` has them.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.chunks import LANES, marks
from jointwave.dem.kernel.model import KernelFlags, Model, Samples, State
from jointwave.dem.kernel.motion import AFTER, SUMMED
from jointwave.dem.kernel.parts import (
    Part,
    add_up,
    divided,
    flat,
    part_of,
    take_together,
    work_for,
)
from jointwave.dem.kernel.rotation import free_motion
from jointwave.dem.kernel.step import step_for
from jointwave.dem.sides.shaking import motion_of_walls
from jointwave.numerics.borrowed import borrowed
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
    the mass that gravity pulls of each block, numbers, matrices and springs of held blocks, places
    and rows of recorded ones [2, r], `back`, the inverse of the tensor, and `free`, as
    `rotation.free_motion` has it."""

    inertia: np.ndarray
    inverse: np.ndarray
    mass: np.ndarray
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
    ends, depth = divided(chunks, state.history, f, threads)
    bands = max(1, -(-stages * most // depth))
    depth = max(1, -(-stages * most // bands))  # alike in all
    loop, inertia = loop_for(form), model.inertia.ravel()
    mass = np.ascontiguousarray(own.inertia[:, 0] if own.mass is None else own.mass)
    first_place, places = marks(model.places, chunks.first_block)
    first_seen, seen = marks(chunks.place[model.watched], LANES * chunks.first_chunk)
    first_held = np.searchsorted(np.zeros(0) if held is None else held, chunks.first_block)
    tiles = np.stack([chunks.first_chunk, chunks.first_block, first_held, first_place, first_seen])
    between = ChunkTable(
        chunks.pair, chunks.table, chunks.row_from, model.laws, tiles, seen,
        len(chunks.place),
    )  # fmt: skip
    blocks = BlockTable(
        inertia, 1.0 / inertia, mass, held, matrices, springs, places, own.gravity, own.tensor,
        None if own.tensor is None else np.linalg.inv(own.tensor),
        free_motion(own) if form.finite else None, dt, own.keep, own.local, own.stages,
    )  # fmt: skip
    size = form.buffer.before + f * int(np.diff(chunks.first_block).max())
    works = [work_for(inertia.size, size, depth, form.ledger) for _ in ends[1:]]
    whole = Part(ends[0], ends[-1], tiles, state, samples, works[0])
    shares = zip(ends[:-1], ends[1:], works, strict=True)
    parts = [part_of(whole, *one) for one in shares] if len(works) > 1 else []

    def take(stride: int, first: int, last: int, keep: float = own.keep) -> None:
        count = last - first
        if count > most:
            raise ValueError(f"{count} steps at a time, at most {most}")
        if walls is not None and shake is not None:
            walls[: count + 1] = motion_of_walls(state, shake[:count], dt)
        damped = blocks._replace(keep=keep)
        steps = stages * first, stages * last, depth

        def advance(part: Part, begin: int, end: int) -> None:
            span = part.first, part.last, steps[0], begin, end, stages * stride, depth
            table = between._replace(tiles=part.tiles)
            loop(table, damped, flat(part.state), part.samples, drive, walls, part.work, span)

        if not parts or first == last:  # nothing to take: compiles
            advance(whole, *steps[:2])
        else:
            take_together(whole, parts, model.walls, steps, advance)
            add_up(whole, parts, slice(-(-first // stride), -(-last // stride)))
        if walls is not None:
            u, v = walls[count].reshape(2, -1, f)[:, 1:]
            state.u[-model.walls :], state.v[-model.walls :] = u, v

    return take


def widths_of(form: KernelFlags) -> tuple[int, ...]:
    """Return how many lanes of each term of the ledger there are, 0 of terms that are absent."""
    parts, held, lanes = form.parts, int(form.held), LANES
    damped = form.mass_damping or form.local_damping
    return (
        lanes, lanes, lanes * (parts.dashpots or damped),
        lanes * (form.points and form.dim > 1), lanes * parts.softening, held,
        int(form.gravity), lanes if form.shaken else held,
    )  # fmt: skip


@cache
def loop_for(form: KernelFlags) -> Callable:
    """Return the time loop of blocks with these effects; absent ones are not compiled."""
    step, has_ledger, widths = step_for(form), form.ledger, widths_of(form)

    def loop(chunks, blocks, state, samples, drive, walls, work, span):
        """Take the steps begin .. end - 1 of the tiles first .. last - 1, in bands of `depth`.

        Diagonal k of a band has tile k - j at its step j. Of tiles beyond the first and the last,
        those take a step on which later ones of the band depend; the band leaves these and their
        neighbours with motion that is not theirs.

        work : `parts.Work`. span : first, last, the first step in `drive` and `walls`, begin, end,
        stride, depth.
        """
        setting = flush_denormals()
        chunks, blocks, state = borrowed(chunks), borrowed(blocks), borrowed(state)
        samples, drive, walls = borrowed(samples), borrowed(drive), borrowed(walls)
        work = borrowed(work)
        first, last, origin, begin, end, stride, depth = span
        tiles, ledgers, ledger = chunks.tiles.shape[1] - 1, work.ledgers, None
        for n in range(begin, end, depth):
            steps = depth if depth < end - n else end - n
            from_tile = first - steps if first > steps else 0
            to_tile = last + steps if last + steps < tiles else tiles
            for k in range(from_tile, to_tile + steps - 1):
                for j in range(steps):
                    t, later = k - j, steps - 1 - j
                    if t < 0 or t < first - 1 - later or t >= tiles or t >= last + later:
                        continue
                    if has_ledger:
                        ledger = ledgers[j if t >= first and t < last else depth]
                    s = (n + j) // stride if (n + j) % stride == 0 else -1
                    step(
                        chunks, blocks, state, work.force, drive, walls, samples, work.buffer,
                        ledger, t, n + j - origin, s,
                    )  # fmt: skip
            if has_ledger:
                for j in range(n, n + steps):
                    one = ledgers[j - n]
                    for term in range(state.sums.size):
                        row, before, after = term * LANES, 0.0, 0.0
                        sampled, summed = j % stride == 0, row in SUMMED
                        for i in range(row, row + (widths[term] if sampled or summed else 0)):
                            before, after = before + one[i], after + one[AFTER + i]  # in order
                            one[i], one[AFTER + i] = 0.0, 0.0
                        if sampled:
                            samples.energy[term, j // stride] = state.sums[term] + before
                        if summed:
                            state.sums[term] += before + after
        restore_denormals(setting)

    return jitted(loop, form)
