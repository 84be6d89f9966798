"""Leapfrog steps of rigid blocks in the plane: the order in which tiles take their steps.

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

from jointwave.dem.blocks.model import KernelFlags, PlaneModel, PlaneState
from jointwave.dem.blocks.tile import AFTER, BEFORE, CONTACT_ROWS, SUMMED, step_for
from jointwave.dem.blocks.tiles import LANES, depth_of, marks
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.atomic import give_way, peek, post
from jointwave.numerics.cache_lines import zeros
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted
from jointwave.results.rock_mass import TERMS


class PlaneSamples(NamedTuple):
    """What is recorded: displacement and velocity of blocks [place, 3, sample], m and m/s, rad and
    rad/s, force, opening and slip of contacts [watched, CONTACT_ROWS, sample], and the ledger
    [term, sample], J; None without."""

    displacement: np.ndarray
    velocity: np.ndarray
    contact: np.ndarray
    energy: Any


def samples_for(model: PlaneModel, count: int) -> PlaneSamples:
    """Return empty samples of this number."""
    displacement, velocity = np.zeros((2, len(model.places), 3, count))
    contact = np.zeros((len(model.watched), CONTACT_ROWS, count))
    energy = np.zeros((len(TERMS), count)) if model.form.ledger else None
    return PlaneSamples(displacement, velocity, contact, energy)


def march(
    model: PlaneModel,
    state: PlaneState,
    samples: PlaneSamples,
    stride: int,
    steps: tuple[int, int],
    drive: np.ndarray | None = None,
    shake: np.ndarray | None = None,
    threads: int = 1,
) -> None:
    """Take the steps first .. last - 1, with their samples, `stride` steps apart.

    drive : float array [last - first, h, 3], N and N m, forces on held blocks in each step.
    shake : float array [last - first, walls, 2], the velocity of walls in each step, m/s.
    """
    take = make_stepper(model, state, samples, steps[1] - steps[0], drive, shake, threads)
    take(stride, *steps)


def make_stepper(
    model: PlaneModel,
    state: PlaneState,
    samples: PlaneSamples,
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
    form, b, contacts = model.form, model.blocks, model.contacts
    held, first_held = model.held or (None, None, None, None), None
    if model.held is None:
        drive = None  # one kernel, whoever asks
    else:
        first_held = np.searchsorted(model.held.block, contacts.first_block)
        if drive is None:
            drive = np.zeros((most, len(model.held.block), 3))
    walls = None if shake is None else motion_of_walls(state, shake, b.dt)
    widest = np.diff(contacts.first_block).max()
    bands = -(-most // depth_of(contacts, state.history, threads))
    bands = max(1, bands + -bands % threads)  # as many for each thread
    depth = max(1, -(-most // bands))
    buffers = zeros((threads, BEFORE + 3 * int(widest)))
    ledgers = zeros((threads * depth, 2 * AFTER)) if form.ledger else None
    progress = np.zeros(threads + 1, dtype=np.int64)
    loop, inertia = loop_for(form), b.inertia.ravel()
    inverse, force = 1.0 / inertia, np.zeros(inertia.size)

    given = Packed(
        contacts.pair, contacts.table, model.laws, model.rules, contacts.first_chunk,
        contacts.first_block, inertia, inverse, first_held, *held, state.u.reshape(-1),
        state.v.reshape(-1), state.history, drive, walls, force,
        *marks(model.places, contacts.first_block),
        *marks(contacts.place[model.watched], LANES * contacts.first_chunk),
        *samples, state.sums, ledgers, buffers, progress, len(contacts.place), b.dt,
        b.local, b.gravity_x, b.gravity_y, depth, distinct=True,
    )  # fmt: skip

    def take(stride: int, first: int, last: int, keep: float = b.keep) -> None:
        count = last - first
        if count > most:
            raise ValueError(f"{count} steps at a time, at most {most}")
        progress[:] = 0
        if walls is not None and shake is not None:
            walls[: count + 1] = motion_of_walls(state, shake[:count], b.dt)

        def share(thread: int) -> None:
            loop(given, thread, first, last, stride, keep)

        if threads == 1 or first == last:  # nothing to take: compiles
            share(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(share, range(threads)))
        if walls is not None:
            u, v = walls[count].reshape(2, -1, 3)[:, 1:, :2]
            state.u[-model.walls :, :2], state.v[-model.walls :, :2] = u, v

    return take


def motion_of_walls(state: PlaneState, shake: np.ndarray, dt: float) -> np.ndarray:
    """Return displacement and velocity of walls that move as `shake` says [steps + 1, 2,
    3 (1 + walls)], before each step and after the last, none at first."""
    steps, walls, _ = shake.shape
    found = np.zeros((steps + 1, 2, 1 + walls, 3))
    found[0, :, 1:] = state.u[-walls:], state.v[-walls:]
    found[1:, 1, 1:, :2] = shake
    found[1:, 0, 1:, :2] = dt * shake
    found[:, 0] = found[:, 0].cumsum(axis=0)
    return found.reshape(steps + 1, 2, -1)


@cache
def loop_for(form: KernelFlags) -> Callable:
    """Return the time loop of rock masses with these effects; absent ones are not compiled."""
    step = step_for(form)
    has_ledger = form.ledger

    @jitted
    def loop(given, thread, first, last, stride, keep):
        """Take this thread's share of the steps first .. last - 1, in turn with the others.

        Band B of `depth` steps belongs to thread B modulo their number; its diagonal k has tile
        k - j at its step j. It enters one when band B - 1 has left the one that asks for the last
        of its own steps at the next tile.

        given : of `march`; inertia, inverse and force have an entry for each freedom, one over it,
        and zero. progress : diagonals that each thread has left behind, as many for each band, and
        how many bands have closed their ledgers.
        """
        setting = flush_denormals()
        (
            pair, table, laws, rules, first_chunk, first_block, inertia, inverse, first_held, block,
            keeps, moves, dashpot, u, v, history, drive, walls, force, first_place, place,
            place_row, first_seen, seen, seen_row, displacement, velocity, contact, energy, sums,
            ledgers, buffers, progress, contacts, dt, local, g_x, g_y, depth,
        ) = unpacked(given)  # fmt: skip
        tiles, size, threads = first_chunk.size - 1, inertia.size, progress.size - 1
        buffer, ledger = buffers[thread], None
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
                    step(
                        pair, table, laws, rules, first_chunk, first_block, inertia, inverse,
                        first_held, block, keeps, moves, dashpot, u, v, history, drive, walls,
                        force, first_place, place, place_row, first_seen, seen, seen_row,
                        displacement, velocity, contact, ledger, buffer, contacts, size, dt, keep,
                        local, g_x, g_y, k - j, n + j - first, (n + j) % stride == 0,
                        (n + j) // stride,
                    )  # fmt: skip
                post(progress, thread, band * diagonals + k + 1)
            while peek(progress, threads) < band:
                give_way()
            if has_ledger:
                for j in range(n, n + steps):
                    one = ledgers[thread * depth + j - n]
                    for term in range(sums.size):
                        before, after = 0.0, 0.0
                        for i in range(term * LANES, (term + 1) * LANES):  # always in this order
                            before, after = before + one[i], after + one[AFTER + i]
                            one[i], one[AFTER + i] = 0.0, 0.0
                        if j % stride == 0:
                            energy[term, j // stride] = sums[term] + before
                        if term * LANES in SUMMED:
                            sums[term] += before + after
            post(progress, threads, band + 1)
        restore_denormals(setting)

    return loop
