"""Leapfrog steps of rigid blocks: arguments of the kernel, and its calls from threads."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.chunks import LANES, marks
from jointwave.dem.kernel.loop import loop_for
from jointwave.dem.kernel.model import Model, Samples, State
from jointwave.dem.kernel.parts import (
    ChunkTable,
    bands_for,
    collect,
    divided,
    hand_out,
    parts_of,
    work_for,
)
from jointwave.dem.kernel.rotation import free_motion
from jointwave.dem.sides.shaking import motion_of_walls
from jointwave.numerics.jit import limited_threads


class BlockTable(NamedTuple):
    """Blocks as arguments of the kernel; other fields as in `model.Blocks` and `model.Held`.

    inverse : one over the inertia of each freedom. mass : gravitational mass of each block, kg.
    places : places and sample rows of recorded blocks [2, r]. back : inverse of the inertia tensor.
    free : constants of free rotation, see `rotation.free_motion`.
    """

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
    """Take the steps first .. last - 1 and sample every `stride` steps.

    drive : forces on held blocks in each step [last - first, h, freedoms], N and N m; of composed
    steps in each stage [(last - first) stages, ...], at `composition.instants`.
    shake : velocity of walls in each step [last - first, walls, dim], m/s.
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
    """Return a function of (stride, first, last) that takes at most `most` steps per call.

    drive, shake : as in `march`, from step `first` on; read at each call, so the caller may refill
    them. The function also accepts `keep`, the factor of mass-proportional damping per step.
    """
    form, chunks, f = model.form, model.chunks, model.form.freedoms
    own, dt, stages = model.blocks, model.blocks.dt, form.stages
    held, matrices, springs = model.held or (None, None, None)
    if held is None:
        drive = None  # the same kernel for all callers
    elif drive is None:
        drive = np.zeros((stages * most, len(held), f))
    walls = None if shake is None else motion_of_walls(state, shake, dt)
    ends, depth = divided(chunks, state.history, f, threads)
    bands = max(1, -(-stages * most // depth))
    depth = max(1, -(-stages * most // bands))  # bands of equal depth
    several, inertia = len(ends) > 2, model.inertia.ravel()
    loop = bands_for(form) if several else loop_for(form)
    mass = np.ascontiguousarray(own.inertia[:, 0] if own.mass is None else own.mass)
    first_place, places = marks(model.places, chunks.first_block)
    first_seen, seen = marks(chunks.place[model.watched], LANES * chunks.first_chunk)
    first_held = np.searchsorted(np.zeros(0) if held is None else held, chunks.first_block)
    tiles = np.stack([chunks.first_chunk, chunks.first_block, first_held, first_place, first_seen])
    table = ChunkTable(
        chunks.pair, chunks.table, chunks.row_from, model.laws, tiles, seen,
        len(chunks.place),
    )  # fmt: skip
    blocks = BlockTable(
        inertia, 1.0 / inertia, mass, held, matrices, springs, places, own.gravity, own.tensor,
        None if own.tensor is None else np.linalg.inv(own.tensor),
        free_motion(own) if form.finite else None, dt, own.keep, own.local, own.stages,
    )  # fmt: skip
    size = form.buffer.before + f * int(np.diff(chunks.first_block).max())
    work = work_for(inertia.size, size, depth, form.ledger, len(ends) - 1)
    flat = state._replace(u=state.u.reshape(-1), v=state.v.reshape(-1))
    parts = parts_of(state, samples, tiles, ends, work) if several else None

    def take(stride: int, first: int, last: int, keep: float = own.keep) -> None:
        count = last - first
        if count > most:
            raise ValueError(f"{count} steps at a time, at most {most}")
        if walls is not None and shake is not None:
            walls[: count + 1] = motion_of_walls(state, shake[:count], dt)
        damped = blocks._replace(keep=keep)
        span = stages * first, stages * first, stages * last, stages * stride, depth
        if parts is not None:
            hand_out(state, parts, model.walls)
            with limited_threads(len(ends) - 1):
                loop(table, damped, *parts, drive, walls, span)
            collect(state, samples, parts, slice(-(-first // stride), -(-last // stride)))
        else:
            loop(table, damped, flat, samples, drive, walls, work, (0, ends[-1], *span))
        if walls is not None:
            u, v = walls[count].reshape(2, -1, f)[:, 1:]
            state.u[-model.walls :], state.v[-model.walls :] = u, v

    return take
