"""Leapfrog steps of rigid blocks: from a model to the arguments of the kernel.

Threads have parts of the tiles, as `dem.kernel.parts` has them.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.chunks import LANES, marks
from jointwave.dem.kernel.loop import loop_for
from jointwave.dem.kernel.model import Model, Samples, State
from jointwave.dem.kernel.parts import Part, add_up, divided, flat, part_of, take_together, work_for
from jointwave.dem.kernel.rotation import free_motion
from jointwave.dem.sides.shaking import motion_of_walls


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
