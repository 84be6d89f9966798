"""Contacts in chunks of 64, and tiles of chunks and blocks that a pass takes through many steps.

Contacts are ordered by the lower of their block numbers. A tile's contacts join its own blocks to
one another and to those of the next tile only. So all forces on a tile's blocks are complete after
its own contacts and those of the tile before. Tiles are small if neighbours have close numbers.
"""

from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.faces import Contacts
from jointwave.numerics.cache_lines import zeros

LANES = 64  # contacts in a chunk
LEAST = 16  # chunks of a tile: a step of a tile has an overhead of some 0.2 us


class Chunks(NamedTuple):
    """Contacts in chunks, and tiles of chunks.

    pair : int32 [chunks, 2 LANES], offsets of the motion of blocks i and j (number times freedoms);
    where joints differ, a third row has the column of the law's table. table : [chunks, rows
    LANES], rows as in `KernelFlags.table`. place : of each contact, chunk times LANES plus lane
    [c]. row_from : of a chunk whose contacts join consecutive blocks, the offset of the first; else
    -1 [chunks]. first_chunk, first_block : of each tile [tiles + 1].
    """

    pair: np.ndarray
    table: np.ndarray
    place: np.ndarray
    row_from: np.ndarray
    first_chunk: np.ndarray
    first_block: np.ndarray


def chunks_of(
    contacts: Contacts,
    count: int,
    freedoms: int,
    *,
    law: np.ndarray | None = None,
    extent: np.ndarray | None = None,
    start: np.ndarray | None = None,
    points: np.ndarray | None = None,
    second: np.ndarray | None = None,
) -> Chunks:
    """Return contacts in chunks.

    count : number of blocks; a j from there on is a wall. freedoms : of a block. law : column of
    each contact [c]; None where all joints are equal. start : gap and slips that give the initial
    tractions [c, d], m. points : places in the face, m, from its centre, and area of each point
    [c, points, d]. extent [c, d], m, second [c, d (d - 1) / 2] : as in `KernelFlags.table`.
    """
    blocks, dim = contacts.blocks, contacts.frame.shape[1]
    axes = contacts.frame[:, : (0, 1, 3)[dim - 1]]  # the tangent of the plane follows from n
    rows = [*axes.reshape(len(blocks), -1).T]
    if freedoms > dim:
        rows += [*contacts.arm.reshape(len(blocks), -1).T]
    rows.append(contacts.area)
    for one in (extent, start, second, points):
        rows += [] if one is None else [*one.reshape(len(blocks), -1).T]
    low, high = blocks.min(axis=1), np.where(blocks < count, blocks, 0).max(axis=1)
    order = np.argsort(low, kind="stable")
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    pair = np.stack([*(freedoms * blocks.T), *(() if law is None else [law])])[:, order]
    begins = _tiles(low[order], high[order])
    first = np.append(low[order[LANES * np.array(begins[1:-1], dtype=int)]], count)
    table = _chunks(np.array(rows)[:, order], "constant")
    aligned = zeros(table.shape)
    aligned[:] = table
    pair = _chunks(pair.astype(np.int32), "edge")
    i, j = pair[:, :LANES], pair[:, LANES : 2 * LANES]
    steps = np.diff(i, axis=1)
    if dim == 1:  # its kernel accepts a last chunk that is not full
        steps[-1:, (len(order) - 1) % LANES :] = freedoms
    follow = (steps == freedoms).all(axis=1) & (j - i == freedoms).all(axis=1)
    return Chunks(
        pair,
        aligned,
        place,
        np.where(follow & (j[:, -1] < freedoms * count), i[:, 0], -1),
        np.array(begins),
        np.append(0, first),
    )


def _chunks(values: np.ndarray, mode: Any) -> np.ndarray:
    """Return values [rows, c] as [chunks, rows LANES], the last chunk filled up."""
    rows, number = len(values), -(-values.shape[1] // LANES)
    filled = np.pad(values, ((0, 0), (0, number * LANES - values.shape[1])), mode=mode)
    return filled.reshape(rows, number, LANES).swapaxes(0, 1).reshape(number, rows * LANES)


def _tiles(low: np.ndarray, high: np.ndarray) -> list[int]:
    """Return the first chunk of each tile and the end of the last, from the lower and higher block
    of each contact [c]. A tile begins after all blocks that the tile before the last touches."""
    begins, reach = low[::LANES], np.maximum.accumulate(high)
    found = [0]
    while found[-1] < len(begins) or len(found) == 1:
        g = found[-1]
        beyond = int(np.searchsorted(begins, reach[LANES * g - 1], side="right")) if g else 0
        found.append(min(max(beyond, g + LEAST), len(begins)))
    return found


def marks(at: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sort recorded blocks or contacts at places [n] into tiles that begin at `first` [tiles + 1].

    Return the first of each tile [tiles + 1], and ascending places with rows in the samples [2, n].
    """
    row = np.argsort(at, kind="stable")
    return np.searchsorted(at[row], first), np.stack([at[row], row])
