"""Products and norms of vectors that implicit steps take in every iteration.

scipy and numpy check their operands anew each time, which takes longer than the work itself for a
short pillar. Sums have scipy's order, so results are bit-identical.
"""

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from continuum.model import Interfaces
from numerics.jit import jitted


class Matrix(csr_matrix):
    """A sparse matrix whose products with vectors are compiled."""

    def __matmul__(self, other: Any) -> Any:
        """Return the product with a vector, or what scipy returns for anything else."""
        if type(other) is not np.ndarray or other.ndim != 1 or other.size != self.shape[1]:
            return super().__matmul__(other)
        product = np.empty(self.shape[0])
        multiply(self.indptr, self.indices, self.data, np.ascontiguousarray(other), product)
        return product


@jitted
def multiply(start, column, value, x, product):
    """Set the product of a matrix (CSR) and a vector."""
    for i in range(product.size):
        total = 0.0
        for k in range(start[i], start[i + 1]):
            total += value[k] * x[column[k]]
        product[i] = total


@jitted
def largest(values):
    """Return the largest magnitude of an array [n], 0 if it is empty, NaN if any is NaN."""
    found = 0.0
    for value in values:
        size = abs(value)
        if size > found or size != size:
            found = size
    return found


def compiled_joints(interfaces: Interfaces | None) -> Interfaces | None:
    """Return joints whose operators have compiled products."""
    if interfaces is None:
        return None
    return interfaces._replace(jump=Matrix(interfaces.jump), spread=Matrix(interfaces.spread))
