"""Jump operators whose rows repeat: one place in the faces of blocks that share a tile.

Between alike blocks the jump at one place of their faces has the same coefficients at every joint,
and the columns move on by one from a joint to the next. Such rows are one stencil, applied in a few
loops over neighbouring numbers, which the compiler vectorises. A row that repeats nothing is a
stencil of its own.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, hstack

from jointwave.joints.formula import formula

ONE, TWO = np.uint64(1), np.uint64(2)
ROUND_OFF = 1e-11  # of coefficients, which are basis functions and of the order of 1


class Stencils(NamedTuple):
    """A sparse matrix as stencils, for compiled code.

    first : [stencils + 1]; stencil r makes rows first[r] .. first[r + 1] - 1.
    start : [stencils + 1]; row first[r] + i has entries start[r] .. start[r + 1] - 1, `value`
        in the columns `column` + i. All unsigned: compiled code need not ask whether an index
        counts from the end, and so vectorises.
    """

    first: np.ndarray
    start: np.ndarray
    column: np.ndarray
    value: np.ndarray


def stencils(matrix: csr_matrix) -> Stencils:
    """Return a sparse matrix as stencils of neighbouring rows."""
    matrix = csr_matrix(matrix)
    matrix.sort_indices()
    begins = np.flatnonzero(_begins(matrix))
    entries = np.diff(matrix.indptr)[begins]
    start = np.concatenate([[0], np.cumsum(entries)])
    kept = np.repeat(matrix.indptr[begins] - start[:-1], entries) + np.arange(start[-1])
    first = np.append(begins, matrix.shape[0])
    first, start, column = (a.astype(np.uint64) for a in (first, start, matrix.indices[kept]))
    return Stencils(first, start, column, matrix.data[kept])


def _begins(matrix: csr_matrix) -> np.ndarray:
    """Return for each row whether it does not repeat the one before, a column further on."""
    entries = np.diff(matrix.indptr)
    begins = np.ones(entries.size, dtype=bool)
    begins[1:] = entries[1:] != entries[:-1]
    row = np.repeat(np.arange(entries.size), entries)
    before = np.arange(row.size) - entries[row]  # the same entry of the row before
    moved = matrix.indices == matrix.indices[before] + 1
    same = np.abs(matrix.data - matrix.data[before]) <= ROUND_OFF
    begins[row[~(moved & same)]] = True
    return begins


def distinct(matrices: list[csr_matrix]) -> tuple[np.ndarray, np.ndarray]:
    """Return (rows, group): rows that differ, in the order of their first column, and for each
    row of the matrices, taken together, its number among them.

    Quadrature points of neighbouring facets that fall on the same nodes have the same jumps at all
    times, so the same traction: one point with the weight of all of them.
    """
    whole = csr_matrix(hstack(matrices))
    whole.sort_indices()
    entries = np.diff(whole.indptr)
    row = np.repeat(np.arange(entries.size), entries)
    place = np.arange(row.size) - whole.indptr[row]
    table = np.zeros((entries.size, 2 * entries.max(initial=0)), dtype=np.int64)
    table[row, place] = whole.indices + 1
    table[row, place + entries.max(initial=0)] = np.round(whole.data / (100 * ROUND_OFF))
    _, first, group = np.unique(table, axis=0, return_index=True, return_inverse=True)
    return first, group.ravel()


@formula
def multiply_stencils(first, start, column, value, x, y, begin):
    """Set y = B x in the rows of stencils `begin` and after; y is not x."""
    for r in range(begin, first.size - 1):
        row, rows, k, end = first[r], first[r + 1] - first[r], start[r], start[r + 1]
        if end - k == TWO:  # where nodes face each other
            a, b, one, other = value[k], value[k + ONE], column[k], column[k + ONE]
            for i in range(rows):
                y[row + i] = a * x[one + i] + b * x[other + i]
        else:
            for i in range(rows):
                y[row + i] = 0.0
            for entry in range(k, end):
                a, one = value[entry], column[entry]
                for i in range(rows):
                    y[row + i] += a * x[one + i]


@formula
def add_transposed(first, start, column, value, t, f):
    """Add B^T t to f."""
    for r in range(first.size - 1):
        row, rows = first[r], first[r + 1] - first[r]
        for k in range(start[r], start[r + 1]):
            a, one = value[k], column[k]
            for i in range(rows):
                f[one + i] += a * t[row + i]
