"""Sparse matrices in compiled code."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from joints.jit import jitted


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


@jitted
def row(start, column, value, x, i):
    """Return row i of a sparse matrix times x; arrays, for a tuple would count its references."""
    total = 0.0
    for k in range(start[i], start[i + 1]):
        total += value[k] * x[column[k]]
    return total
