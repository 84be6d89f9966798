"""Parts of rigid blocks, one for each thread.

A part owns consecutive tiles and its own copy of the state. It takes `depth` steps between two
exchanges with its neighbours, and therefore also steps the neighbours' tiles on which its own
depend, one tile less in each step. What two parts compute, both compute from the same numbers in
the same order, so the motion is bit for bit that of one thread.
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

ROWS = BLOCK, BLOCK, CHUNK, None, HELD, BLOCK  # of the tiles' table, for each field of a state
DEEPEST, CACHE = 16, 3 << 19  # limits of a pass: steps, and bytes of a core's own cache
OF_FREEDOM = 32  # bytes of its motion, inertia and force
THIN = 16  # least number of tiles for each step between exchanges and each border
ENOUGH_BLOCKS = {1: 200_000, 2: 40_000, 3: 40_000}  # from which threads pay, by dimension
FEWEST = 4  # tiles of a part: both neighbours would step two


class Work(NamedTuple):
    """Work arrays of the kernel.

    force : on all blocks, zero between steps. buffer : of a chunk and a tile. ledgers : of each
    step of a band, the last one for tiles of other parts [depth + 1, 2 AFTER], zero between bands.
    """

    force: np.ndarray
    buffer: np.ndarray
    ledgers: Any


class Part(NamedTuple):
    """A part of the blocks.

    first, last : its tiles are first .. last - 1. tiles : the tiles' table, without recorded blocks
    and contacts in tiles of other parts. state, samples : arrays of full size, in which it uses its
    own rows and some of its neighbours'; sums and energy hold the contribution of its own tiles.
    """

    first: int
    last: int
    tiles: np.ndarray
    state: State
    samples: Samples
    work: Work


def work_for(numbers: int, buffer: int, depth: int, has_ledger: bool) -> Work:
    """Return work arrays for so many force components, and a buffer of this size."""
    ledgers = zeros((depth + 1, 2 * AFTER)) if has_ledger else None
    return Work(np.zeros(numbers), zeros(buffer), ledgers)


def divided(
    chunks: Chunks, history: np.ndarray | None, freedoms: int, threads: int
) -> tuple[list[int], int]:
    """Return the first tile of each part, with the end of the last, and the steps of a pass.

    A pass takes as many steps as a core's own cache holds tiles, but fewer if many tiles were then
    stepped by two parts. All parts step about as many chunks; few tiles make fewer parts.
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
    """Return the part that owns the tiles first .. last - 1, with a state of zeros."""
    tiles, samples = whole.tiles.copy(), whole.samples
    for row in (PLACE, SEEN):
        tiles[row] = tiles[row].clip(tiles[row, first], tiles[row, last])
    if samples.energy is not None:
        samples = samples._replace(energy=np.zeros_like(samples.energy))
    return Part(first, last, tiles, like(whole.state), samples, work)


def like(state: State) -> State:
    """Return a state of zeros; rows that are never used take no memory."""
    return State._make(None if one is None else zeros(one.shape) for one in state)


def flat(state: State) -> State:
    """Return a state with flat arrays of motion, as the kernel needs them."""
    return state._replace(u=state.u.reshape(-1), v=state.v.reshape(-1))


def copy(source: State, target: State, tiles: np.ndarray, first: int, last: int) -> None:
    """Copy the rows of the existing tiles among first .. last - 1, in fields that both have."""
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
    """Step all parts, each on its own thread.

    walls : their number. steps : first, one beyond the last, and number between exchanges.
    advance(part, begin, end) : takes the steps begin .. end - 1 of a part.
    """
    first, last, depth = steps
    state, barrier, freedoms = whole.state, Barrier(len(parts)), whole.state.u.shape[1]
    edges = [like(state), like(state)]
    if depth == 1:  # each part then steps all contacts that it needs
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
                exchange(part, edges[number % 2])  # other threads may still read the other buffer
            incomplete = freedoms * block[b], freedoms * block[min(b + depth, whole.last)]
            part.work.force[slice(*incomplete)] = 0.0
            advance(part, begin, min(begin + depth, last))
        copy(own, state, part.tiles, a, b)

    def guarded(part: Part) -> None:
        try:
            take(part)
        except BaseException:
            barrier.abort()  # else other threads wait forever
            raise

    if state.sums is not None:
        for part in parts:
            part.state.sums[:] = state.sums if part is parts[0] else 0.0
    with ThreadPoolExecutor(len(parts)) as pool:
        list(pool.map(guarded, parts))


def add_up(whole: Part, parts: list[Part], samples: slice) -> None:
    """Sum the ledgers of all parts."""
    if whole.state.sums is not None:
        whole.state.sums[:] = sum(part.state.sums for part in parts)
        found = [part.samples.energy[:, samples] for part in parts]
        whole.samples.energy[:, samples] = sum(found)


def thread_count(asked: int | None, blocks: int, dim: int) -> int:
    """Return the threads to use: as requested, else one for few blocks and all cores for many."""
    if asked is not None:
        return asked
    return _cores() if blocks >= ENOUGH_BLOCKS[dim] else 1


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
