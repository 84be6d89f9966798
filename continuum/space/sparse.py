"""Sparse matrices in compiled code."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from joints.jit import inlined


class Rows(NamedTuple):
    """A sparse matrix by its rows, for compiled code: row i holds start[i] .. start[i + 1] - 1."""

    start: np.ndarray
    column: np.ndarray
    value: np.ndarray


def rows(matrix: csr_matrix) -> Rows:
    """Return a sparse matrix for compiled code."""
    matrix = csr_matrix(matrix)
    matrix.sort_indices()
    return Rows(matrix.indptr, matrix.indices, matrix.data)


def sparse(rows: Rows, columns: int) -> csr_matrix:
    """Return a matrix of compiled code as scipy's; inverse of `rows`."""
    return csr_matrix((rows.value, rows.column, rows.start), (rows.start.size - 1, columns))


@inlined
def row(matrix, x, i):
    """Return row i of a sparse matrix times x."""
    total = 0.0
    for k in range(matrix.start[i], matrix.start[i + 1]):
        total += matrix.value[k] * x[matrix.column[k]]
    return total
