"""Jump operators whose rows repeat: one place in the faces of blocks that stand in a tile.

Between alike blocks the jump at one place of their faces has the same coefficients at every joint,
and the columns move on by one from a joint to the next. Such a run of rows is a few loops over
neighbouring numbers, which the compiler vectorises. Rows that repeat nothing are runs of one.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, hstack

from joints.jit import inlined, jitted

ROUND_OFF = 1e-11  # of coefficients, which are basis functions and of the order of 1


class Runs(NamedTuple):
    """A sparse matrix by runs of rows.

    Run r holds rows first[r] .. first[r + 1] - 1; row first[r] + i has the entries start[r] ..
    start[r + 1] - 1, value in the columns column + i.
    """

    first: np.ndarray
    start: np.ndarray
    column: np.ndarray
    value: np.ndarray


def runs(matrix: csr_matrix) -> Runs:
    """Return a sparse matrix by runs of neighbouring rows."""
    matrix = csr_matrix(matrix)
    matrix.sort_indices()
    begins = np.flatnonzero(_begins(matrix))
    entries = np.diff(matrix.indptr)[begins]
    start = np.concatenate([[0], np.cumsum(entries)])
    kept = np.repeat(matrix.indptr[begins] - start[:-1], entries) + np.arange(start[-1])
    first = np.append(begins, matrix.shape[0])
    return Runs(first, start, matrix.indices[kept].astype(np.int64), matrix.data[kept])


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


@jitted
def multiply_runs(matrix, x, y):
    """Set y = B x; y is not x."""
    for r in range(matrix.first.size - 1):
        out = y[matrix.first[r] : matrix.first[r + 1]]
        k, end = matrix.start[r], matrix.start[r + 1]
        if end - k == 2:
            combine(matrix, k, x, out)
        else:
            out[:] = 0.0
            for entry in range(k, end):
                accumulate(out, matrix.value[entry], x[matrix.column[entry] :])


@inlined
def combine(matrix, k, x, out):
    """Set the rows of a run with two entries, as where nodes face each other."""
    a, b = matrix.value[k], matrix.value[k + 1]
    one, other = x[matrix.column[k] :], x[matrix.column[k + 1] :]
    for i in range(out.size):
        out[i] = a * one[i] + b * other[i]


@jitted
def add_runs(matrix, t, f):
    """Add B^T t to f."""
    for r in range(matrix.first.size - 1):
        part = t[matrix.first[r] : matrix.first[r + 1]]
        for k in range(matrix.start[r], matrix.start[r + 1]):
            column = matrix.column[k]
            accumulate(f[column : column + part.size], matrix.value[k], part)


@inlined
def accumulate(out, a, x):
    """Add a x to as many numbers as there are in `out`."""
    for i in range(out.size):
        out[i] += a * x[i]
