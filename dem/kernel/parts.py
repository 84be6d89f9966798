"""Parts of rigid blocks, each of which a thread steps.

A part owns consecutive tiles and has a state of its own. It takes `depth` steps between two
exchanges with its neighbours, and for these it also steps some of their tiles: those that its own
depend on, one tile less in each step. What is found twice is found from the same numbers in the
same order, so every bit of the motion is that of one thread.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.chunks import Chunks
from jointwave.dem.kernel.model import Samples, State
from jointwave.dem.kernel.motion import AFTER, BLOCK, CHUNK, HELD, PLACE, SEEN
from jointwave.numerics.cache_lines import zeros

ROWS = BLOCK, BLOCK, CHUNK, None, HELD, BLOCK  # of the tiles' table: what has the fields of a state
DEEPEST, CACHE = 16, 3 << 19  # steps, and bytes of a core's own cache, that a pass takes
OF_FREEDOM = 32  # bytes: its motion, inertia and force
THIN = 16  # tiles for each step between exchanges and each border
ENOUGH_BLOCKS = {1: 200_000, 2: 40_000, 3: 40_000}  # by dimension: from there on threads pay
FEWEST = 4  # tiles of a part: two would be stepped by both neighbours


class Work(NamedTuple):
    """What the kernel works on: forces on all blocks, zero, a buffer, and ledgers of the steps of a
    band, zero, with one for tiles that others own [depth + 1, 2 AFTER]."""

    force: np.ndarray
    buffer: np.ndarray
    ledgers: Any


class Part(NamedTuple):
    """A part of the blocks.

    first, last : its tiles. tiles : the tiles' table, in which tiles of others record nothing.
    state, samples : arrays as large as those of the whole, of which it touches its own rows and
    some beside them. The ledger of its samples and its sums have what its tiles contribute.
    """

    first: int
    last: int
    tiles: np.ndarray
    state: State
    samples: Samples
    work: Work


def work_for(numbers: int, buffer: int, depth: int, has_ledger: bool) -> Work:
    """Return what the kernel works on; numbers : of forces. buffer : its size, in numbers."""
    ledgers = zeros((depth + 1, 2 * AFTER)) if has_ledger else None
    return Work(np.zeros(numbers), zeros(buffer), ledgers)


def divided(
    chunks: Chunks, history: np.ndarray | None, freedoms: int, threads: int
) -> tuple[list[int], int]:
    """Return the first tile of each part, and where the last one ends, and how many steps a pass
    over the tiles takes: as many as a core's own cache holds tiles, as far as few tiles are then
    stepped by two parts.

    All parts have as many chunks to step. There are fewer parts than threads of few tiles.
    """
    tiles = len(chunks.first_chunk) - 1
    threads = max(1, min(threads, tiles // FEWEST))
    whole = sum(x.nbytes for x in (chunks.pair, chunks.table, history) if x is not None)
    sizes = whole / max(1, len(chunks.pair)) * np.diff(chunks.first_chunk)
    sizes += OF_FREEDOM * freedoms * np.diff(chunks.first_block)
    depth = min(DEEPEST, int(CACHE / sizes.max()))
    if threads > 1:
        depth = min(depth, tiles // (THIN * (threads - 1)))
    depth = max(1, depth)
    place = chunks.first_chunk * (tiles / max(1, chunks.first_chunk[-1]))
    inner = np.arange(1, threads) * ((tiles - depth) / threads) + 0.5 * (depth + 1)
    found = np.abs(place[:, None] - inner).argmin(axis=0)
    return np.unique([0, *found, tiles]).tolist(), depth


def part_of(whole: Part, first: int, last: int, work: Work) -> Part:
    """Return the part that owns the tiles first .. last - 1, at rest."""
    tiles, samples = whole.tiles.copy(), whole.samples
    for row in (PLACE, SEEN):
        tiles[row] = tiles[row].clip(tiles[row, first], tiles[row, last])
    if samples.energy is not None:
        samples = samples._replace(energy=np.zeros_like(samples.energy))
    return Part(first, last, tiles, like(whole.state), samples, work)


def like(state: State) -> State:
    """Return a state of zeros; rows that are never touched take no memory."""
    return State._make(None if one is None else zeros(one.shape) for one in state)


def flat(state: State) -> State:
    """Return a state with motion as the kernel takes it."""
    return state._replace(u=state.u.reshape(-1), v=state.v.reshape(-1))


def copy(source: State, target: State, tiles: np.ndarray, first: int, last: int) -> None:
    """Copy what both states have of tiles first .. last - 1, as far as there are such."""
    begin, end = tiles[:, max(first, 0)], tiles[:, min(last, tiles.shape[1] - 1)]
    for one, other, row in zip(source, target, ROWS, strict=True):
        if one is not None and other is not None and row is not None:
            other[begin[row] : end[row]] = one[begin[row] : end[row]]


def take_together(
    whole: Part,
    parts: list[Part],
    walls: int,
    steps: tuple[int, int, int],
    advance: Callable[[Part, int, int], None],
) -> None:
    """Take steps of all parts, each on a thread of its own.

    walls : their number. steps : the first, one beyond the last, and how many between exchanges.
    advance : of a part, the first step and one beyond the last, takes so many.
    """
    first, last, depth = steps
    state, barrier, freedoms = whole.state, Barrier(len(parts)), whole.state.u.shape[1]
    edges = [like(state), like(state)]
    if depth == 1:  # then each contact is stepped by all that need it
        edges = [edge._replace(history=None) for edge in edges]

    def exchange(part: Part, edge: State) -> None:
        a, b, own, tiles = part.first, part.last, part.state, part.tiles
        if a > 0:
            copy(own, edge, tiles, a, min(a + depth, b))
        if b < whole.last:
            copy(own, edge, tiles, max(b - depth, a), b)
        barrier.wait()
        copy(edge, own, tiles, a - depth, a)
        copy(edge, own, tiles, b, b + depth)

    def take(part: Part) -> None:
        a, b, own, block = part.first, part.last, part.state, part.tiles[BLOCK]
        copy(state, own, part.tiles, a - depth, b + depth)
        for one, other in (state.u, own.u), (state.v, own.v), (state.turn, own.turn):
            if walls and one is not None:
                other[-walls:] = one[-walls:]
        barrier.wait()
        for number, begin in enumerate(range(first, last, depth)):
            if number > 0:
                exchange(part, edges[number % 2])  # others may still read the other one
            incomplete = freedoms * block[b], freedoms * block[min(b + depth, whole.last)]
            part.work.force[slice(*incomplete)] = 0.0
            advance(part, begin, min(begin + depth, last))
        copy(own, state, part.tiles, a, b)

    def guarded(part: Part) -> None:
        try:
            take(part)
        except BaseException:
            barrier.abort()  # else the others wait forever
            raise

    if state.sums is not None:
        for part in parts:
            part.state.sums[:] = state.sums if part is parts[0] else 0.0
    with ThreadPoolExecutor(len(parts)) as pool:
        list(pool.map(guarded, parts))


def add_up(whole: Part, parts: list[Part], samples: slice) -> None:
    """Put the ledgers of all parts together."""
    if whole.state.sums is not None:
        whole.state.sums[:] = sum(part.state.sums for part in parts)
        found = [part.samples.energy[:, samples] for part in parts]
        whole.samples.energy[:, samples] = sum(found)


def thread_count(asked: int | None, blocks: int, dim: int) -> int:
    """Return the threads to use: as requested, or one for few blocks and all cores for many."""
    if asked is not None:
        return asked
    return _cores() if blocks >= ENOUGH_BLOCKS[dim] else 1


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
