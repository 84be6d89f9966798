"""Parts of rigid blocks, one for each thread.

A part owns consecutive tiles and its own copy of the state. It takes `depth` steps between two
exchanges with its neighbours, and therefore also steps the neighbours' tiles on which its own
depend, one tile less in each step. What two parts compute, both compute from the same numbers in
the same order, so the motion is bit for bit that of one thread.
"""

from collections.abc import Callable, Iterator
from functools import cache
from inspect import unwrap
from itertools import pairwise
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import prange

from jointwave.dem.contacts.chunks import Chunks
from jointwave.dem.kernel.loop import loop_for
from jointwave.dem.kernel.model import KernelFlags, Samples, State
from jointwave.dem.kernel.motion import AFTER, BLOCK, CHUNK, HELD, PLACE, SEEN
from jointwave.joints.formula import formula
from jointwave.numerics.cache_lines import NUMBERS, zeros
from jointwave.numerics.jit import jitted

ROWS = BLOCK, BLOCK, CHUNK, None, HELD, BLOCK  # of the tiles' table, for each field of a state
DEEPEST, CACHE = 16, 3 << 19  # limits of a pass: steps, and bytes of a core's own cache
OF_FREEDOM = 32  # bytes of its motion, inertia and force
THIN = 6  # least number of tiles for each step between exchanges and each border
ENOUGH_BLOCKS = {1: 200_000, 2: 40_000, 3: 40_000}  # from which threads pay, by dimension
FEWEST = 4  # tiles of a part: both neighbours would step two


class ChunkTable(NamedTuple):
    """Contacts as arguments of the kernel.

    pair, table, row_from : as in `chunks.Chunks`. laws : table of the joint laws. tiles : first
    chunk, block, held block, recorded block and watched contact of each tile [5, tiles + 1].
    seen : places and sample rows of watched contacts [2, w]. contacts : their number.
    """

    pair: np.ndarray
    table: np.ndarray
    row_from: np.ndarray
    laws: np.ndarray
    tiles: np.ndarray
    seen: np.ndarray
    contacts: int


class Work(NamedTuple):
    """Work arrays of the kernel; of several parts with one more axis in front.

    force : on all blocks, zero between steps. buffer : of a chunk and a tile. ledgers : of each
    step of a band, the last one for tiles of other parts [depth + 1, 2 AFTER], zero between bands.
    """

    force: np.ndarray
    buffer: np.ndarray
    ledgers: Any


class Parts(NamedTuple):
    """The parts of a system of blocks; arrays have the part as first index.

    ends : first tile of each part, and the end of the last. tiles : the tiles' table, where only
    its own tiles have recorded blocks and contacts. state : of full size; each part uses the rows
    of its own tiles and some of its neighbours'. samples : all parts share them, but the ledger.
    """

    ends: np.ndarray
    tiles: np.ndarray
    state: State
    samples: Samples
    work: Work


def work_for(numbers: int, buffer: int, depth: int, has_ledger: bool, parts: int) -> Work:
    """Return work arrays for so many force components, and a buffer of this size."""
    shape = depth + 1, 2 * AFTER
    if parts == 1:
        return Work(np.zeros(numbers), zeros(buffer), zeros(shape) if has_ledger else None)
    ledgers = lines(parts, *shape) if has_ledger else None
    return Work(lines(parts, numbers), lines(parts, buffer), ledgers)


def lines(parts: int, *shape: int) -> np.ndarray:
    """Return zeros for each part; those of one axis start at a cache line and end with one."""
    if len(shape) == 1:
        shape = (-(-shape[0] // NUMBERS) * NUMBERS,)
    return zeros((parts, *shape))


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


def parts_of(
    state: State, samples: Samples, tiles: np.ndarray, ends: list[int], work: Work
) -> Parts:
    """Return parts with these ends, at rest."""
    count = len(ends) - 1
    own = np.stack([tiles] * count)
    for table, (first, last) in zip(own, pairwise(ends), strict=True):
        for row in (PLACE, SEEN):
            table[row] = table[row].clip(table[row, first], table[row, last])
    fields = state._replace(u=state.u.reshape(-1), v=state.v.reshape(-1))
    copies = (one if one is None else lines(count, *one.shape) for one in fields)
    if samples.energy is not None:
        samples = samples._replace(energy=np.zeros((count, *samples.energy.shape)))
    return Parts(np.array(ends), own, State._make(copies), samples, work)


def owned(state: State, parts: Parts) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield rows of the state, and the same rows of the part that owns them."""
    for p, (first, last) in enumerate(pairwise(parts.ends)):
        for one, other, row in zip(state, parts.state, ROWS, strict=True):
            if one is not None and row is not None:
                rows = slice(parts.tiles[p, row, first], parts.tiles[p, row, last])
                yield one[rows], other[p].reshape(-1)[: one.size].reshape(one.shape)[rows]


def hand_out(state: State, parts: Parts, walls: int) -> None:
    """Copy to each part the state of its tiles, and the motion of all walls."""
    for whole, own in owned(state, parts):
        own[:] = whole
    for field in ("u", "v", "turn") if walls else ():
        one, own = getattr(state, field), getattr(parts.state, field)
        if one is not None:
            own[:, one[:-walls].size : one.size] = one[-walls:].reshape(-1)
    if state.sums is not None:
        parts.state.sums[:] = 0.0
        parts.state.sums[0, : state.sums.size] = state.sums


def collect(state: State, samples: Samples, parts: Parts, columns: slice) -> None:
    """Copy from each part the state of its tiles, and add up these samples of the ledgers."""
    for whole, own in owned(state, parts):
        whole[:] = own
    if state.sums is not None:
        state.sums[:] = parts.state.sums.sum(axis=0)[: state.sums.size]
        samples.energy[:, columns] = parts.samples.energy[:, :, columns].sum(axis=0)


@cache
def bands_for(form: KernelFlags) -> Callable:
    """Return the time loop of several parts, each on its own thread."""
    freedoms, finite, matched, has_ledger, remembers = (
        form.freedoms, form.finite, form.matched, form.ledger, form.remembers
    )  # fmt: skip
    loop = unwrap(loop_for(form))

    @formula
    def copy(state, p, q, tiles, first, last):
        """Copy the state of the tiles first .. last - 1 from part q to part p."""
        for i in range(freedoms * tiles[BLOCK, first], freedoms * tiles[BLOCK, last]):
            state.u[p, i], state.v[p, i] = state.u[q, i], state.v[q, i]
        if finite:
            for i in range(tiles[BLOCK, first], tiles[BLOCK, last]):
                state.turn[p, i] = state.turn[q, i]
        if remembers:
            for g in range(tiles[CHUNK, first], tiles[CHUNK, last]):
                for r in range(state.history.shape[2]):
                    state.history[p, g, r] = state.history[q, g, r]
        if matched:
            for r in range(tiles[HELD, first], tiles[HELD, last]):
                for a in range(freedoms):
                    state.closure[p, r, a] = state.closure[q, r, a]

    @formula
    def take_over(ends, tiles, state, force, p, depth):
        """Copy the tiles that part p steps for others from their owners; set the forces that were
        left incomplete there to zero."""
        first, last, count = ends[p], ends[p + 1], ends[ends.size - 1]
        for q in range(ends.size - 1):
            begin, end = max(first - depth, ends[q]), min(last + depth, ends[q + 1])
            if q != p and begin < end:
                copy(state, p, q, tiles, begin, end)
        beyond = min(last + depth, count)
        for i in range(freedoms * tiles[BLOCK, last], freedoms * tiles[BLOCK, beyond]):
            force[i] = 0.0

    @formula
    def own_of(state, samples, work, p, numbers):
        """Return the state of part p, the samples with its ledger, and its work arrays."""
        history: Any = None
        sums: Any = None
        energy: Any = None
        ledgers: Any = None
        closure: Any = None
        turn: Any = None
        if remembers:
            history = state.history[p]
        if has_ledger:
            sums, energy, ledgers = state.sums[p], samples.energy[p], work.ledgers[p]
        if matched:
            closure = state.closure[p]
        if finite:
            turn = state.turn[p]
        return (
            State(state.u[p], state.v[p], history, sums, closure, turn),
            Samples(
                samples.displacement, samples.velocity, samples.contact, energy, samples.closure
            ),
            Work(work.force[p, :numbers], work.buffer[p], ledgers),
        )  # fmt: skip

    def bands(chunks, blocks, ends, tiles, state, samples, work, drive, walls, span):
        """Take the steps begin .. end - 1, in bands of `depth`, between which parts exchange tiles.

        ends, tiles, state, samples, work : as in `Parts`. Others as in `loop`.
        """
        origin, start, stop, stride, depth = span
        for begin in range(start, stop, depth):
            end = min(begin + depth, stop)
            for p in prange(ends.size - 1):
                take_over(ends, tiles[p], state, work.force[p], p, depth)
            for p in prange(ends.size - 1):
                table = ChunkTable(
                    chunks.pair, chunks.table, chunks.row_from, chunks.laws, tiles[p], chunks.seen,
                    chunks.contacts,
                )  # fmt: skip
                own, out, arrays = own_of(state, samples, work, p, blocks.inertia.size)
                part = ends[p], ends[p + 1], origin, begin, end, stride, depth
                loop(table, blocks, own, out, drive, walls, arrays, part)

    return jitted(bands, form, threaded=True)


def thread_count(asked: int | None, blocks: int, dim: int) -> int:
    """Return the threads to use: as requested, else one for few blocks and all cores for many."""
    if asked is not None:
        return asked
    return numba.config.NUMBA_NUM_THREADS if blocks >= ENOUGH_BLOCKS[dim] else 1
