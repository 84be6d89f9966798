"""The stiffness of many alike blocks as one sparse operator, tile by tile.

Blocks of one part share one matrix K, so its entries are read once for a tile of blocks, whose
values of one row stand side by side; a tile's motion stays in the nearest cache while K passes.
A part that occurs once is a tile of width 1: plain sparse rows.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from continuum.space.lanes import WIDTH, add_scaled, load, store, zero
from continuum.space.sparse import Rows
from joints.jit import inlined, jitted
from joints.rows import zeros

TILE = 4  # registers wide; a part's blocks are dealt out evenly, so that tiles have 3 to 5
ROUND_OFF = 1e-13  # of two diagonal entries: what quadrature leaves of entries that are zero


class Layout(NamedTuple):
    """Where the values of blocks stand in a vector: value `row` of block b at first + stride row.

    Blocks are the copies of part 0, then those of part 1, and so on; lanes that no block fills
    are padding, whose values stay zero.

    first, stride : int64 [blocks].
    offset, width, part : int64 [tiles], a tile's first value, its lanes, and whose copies it has.
    length : of a vector, padding included.
    """

    first: np.ndarray
    stride: np.ndarray
    offset: np.ndarray
    width: np.ndarray
    part: np.ndarray
    length: int


class Operator(NamedTuple):
    """A block-diagonal matrix on the vectors of a layout.

    offset, width, size, row : int64 [tiles], a tile's first value, its lanes, the rows of its
        matrix and the first of them in `rows`.
    rows : the matrices of all parts, one below the other; columns are counted within a block.
    """

    offset: np.ndarray
    width: np.ndarray
    size: np.ndarray
    row: np.ndarray
    rows: Rows


def layout(counts, sizes) -> Layout:
    """Return the layout of parts with so many copies [parts] of so many values each [parts]."""
    widths = [tile_widths(count) for count in counts]
    width = np.concatenate(widths)
    part = np.repeat(np.arange(len(widths)), [w.size for w in widths])
    # A tile of width 1 may end within a register: the next one starts with a whole one.
    length = -(-np.asarray(sizes)[part] * width // WIDTH) * WIDTH
    offset = np.cumsum(length) - length
    filled = [np.arange(w.sum()) < count for w, count in zip(widths, counts, strict=True)]
    lane = np.concatenate([np.arange(w) for w in width])
    tile, used = np.repeat(np.arange(width.size), width), np.concatenate(filled)
    first, stride = (offset[tile] + lane)[used], width[tile][used]
    return Layout(first, stride, offset, width, part, int(length.sum()))


def tile_widths(count: int) -> np.ndarray:
    """Return the widths of the tiles that hold so many copies: 1, or whole registers."""
    if count == 1:
        return np.ones(1, dtype=np.int64)
    registers = -(-count // WIDTH)
    tiles = max(1, (registers + TILE // 2) // TILE)
    return WIDTH * (registers // tiles + (np.arange(tiles) < registers % tiles))


def spread(places: Layout, values) -> np.ndarray:
    """Return the vector with the same values [size] in all copies of a part, and in its padding.

    values : an array [size] for each part.
    """
    vector = zeros(places.length)
    for offset, width, part in zip(places.offset, places.width, places.part, strict=True):
        tile = np.repeat(values[part], width)
        vector[offset : offset + tile.size] = tile
    return vector


def operator(places: Layout, matrices) -> Operator:
    """Return the operator of parts with these matrices of one block, [size, size] each."""
    whole = csr_matrix(block_diag([without_round_off(matrix) for matrix in matrices]))
    whole.sort_indices()
    size = np.array([matrix.shape[0] for matrix in matrices], dtype=np.int64)
    row = np.cumsum(size) - size
    column = whole.indices - np.repeat(np.repeat(row, size), np.diff(whole.indptr))
    # Unsigned: compiled code need not ask whether an index counts from the end.
    rows = Rows(whole.indptr.astype(np.uint32), column.astype(np.uint32), whole.data)
    return Operator(places.offset, places.width, size[places.part], row[places.part], rows)


def without_round_off(matrix: csr_matrix) -> csr_matrix:
    """Return a symmetric positive semidefinite matrix without entries that are only round-off.

    No entry exceeds the geometric mean of its two diagonal ones; against that they are measured.
    """
    scale, entries = np.sqrt(np.abs(matrix.diagonal())), csr_matrix(matrix).tocoo()
    real = np.abs(entries.data) > ROUND_OFF * scale[entries.row] * scale[entries.col]
    places = entries.row[real], entries.col[real]
    return csr_matrix((entries.data[real], places), matrix.shape)


@jitted
def multiply(operator, x, y, factor=1.0):
    """Set y = factor K x, whole vectors of the layout; y is not x."""
    for t in range(operator.offset.size):
        multiply_tile(operator, t, x, y, factor)


@inlined
def multiply_tile(operator, t, x, y, factor):
    """Set y = factor K x in tile t."""
    rows, first, size = operator.rows, operator.row[t], operator.size[t]
    width, at = operator.width[t], operator.offset[t]
    if width == 1:
        multiply_one(rows, first, size, x, y, at, factor)
    elif width == 1 * WIDTH:
        multiply_lanes(zero(1), WIDTH, rows, first, size, x, y, at, factor)
    elif width == 2 * WIDTH:
        multiply_lanes(zero(2), 2 * WIDTH, rows, first, size, x, y, at, factor)
    elif width == 3 * WIDTH:
        multiply_lanes(zero(3), 3 * WIDTH, rows, first, size, x, y, at, factor)
    elif width == 4 * WIDTH:
        multiply_lanes(zero(4), 4 * WIDTH, rows, first, size, x, y, at, factor)
    else:
        multiply_lanes(zero(5), 5 * WIDTH, rows, first, size, x, y, at, factor)


@inlined
def multiply_lanes(none, width, rows, first, size, x, y, at, factor):
    """Set y = factor K x in a tile of this width at `at`; `none` is zero in as many registers."""
    start, column, value = rows
    k = start[first]
    for i in range(size):
        total, end = none, start[first + i + 1]
        while k < end:
            values = load(none, x, at + column[k] * width)
            total = add_scaled(total, value[k], values)
            k += 1
        store(y, at + i * width, add_scaled(none, factor, total))


@inlined
def multiply_one(rows, first, size, x, y, at, factor):
    """Set y = factor K x for one block at `at`."""
    start, column, value = rows
    k = start[first]
    for i in range(size):
        total, end = 0.0, start[first + i + 1]
        while k < end:
            total += value[k] * x[at + column[k]]
            k += 1
        y[at + i] = factor * total
