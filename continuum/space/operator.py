"""The stiffness of many alike blocks as one sparse operator, tile by tile.

Blocks of one part share one matrix K, so its entries are read once for a tile of blocks, whose
values of one row stand side by side; a tile's motion stays in the nearest cache while K passes.
A part that occurs once is a tile of width 1: plain sparse rows.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from continuum.space.simd import WIDTH, multiply_tile
from numerics.cache_lines import zeros
from numerics.jit import jitted

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
    """A block-diagonal matrix on the vectors of a layout, for compiled code.

    tiles : int64 [tiles, 4], a tile's first value, its lanes, the first row of its matrix in the
        CSR below, and how many it has.
    start, column (uint32), value : CSR of the matrices of all parts, one below the other; columns
        are counted within a block.
    """

    tiles: np.ndarray
    start: np.ndarray
    column: np.ndarray
    value: np.ndarray


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


def spread(numbering: Layout, values) -> np.ndarray:
    """Return the vector with the same values [size] in all copies of a part, and in its padding.

    values : an array [size] for each part.
    """
    vector = zeros(numbering.length)
    for offset, width, part in zip(numbering.offset, numbering.width, numbering.part, strict=True):
        tile = np.repeat(values[part], width)
        vector[offset : offset + tile.size] = tile
    return vector


def operator(numbering: Layout, matrices) -> Operator:
    """Return the operator of parts with these matrices of one block, [size, size] each."""
    whole = csr_matrix(block_diag(matrices))
    whole.sort_indices()
    size = np.array([matrix.shape[0] for matrix in matrices], dtype=np.int64)
    row = np.cumsum(size) - size
    column = whole.indices - np.repeat(np.repeat(row, size), np.diff(whole.indptr))
    tiles = np.stack([numbering.offset, numbering.width, row[numbering.part], size[numbering.part]])
    start, column = whole.indptr.astype(np.uint32), column.astype(np.uint32)
    return Operator(np.ascontiguousarray(tiles.T), start, column, whole.data)


def without_round_off(matrix: csr_matrix) -> csr_matrix:
    """Return a symmetric positive semidefinite matrix without entries that are only round-off.

    No entry exceeds the geometric mean of its two diagonal ones; against that they are measured.
    """
    scale, entries = np.sqrt(np.abs(matrix.diagonal())), csr_matrix(matrix).tocoo()
    real = np.abs(entries.data) > ROUND_OFF * scale[entries.row] * scale[entries.col]
    places = entries.row[real], entries.col[real]
    return csr_matrix((entries.data[real], places), matrix.shape)


@jitted
def multiply(tiles, start, column, value, x, y, factor):
    """Set y = factor K x of an `Operator` K, whole vectors of the layout; y is not x."""
    for t in range(tiles.shape[0]):
        at, width, first, size = tiles[t, 0], tiles[t, 1], tiles[t, 2], tiles[t, 3]
        multiply_tile(start, column, value, x, y, factor, at, width, first, size)
