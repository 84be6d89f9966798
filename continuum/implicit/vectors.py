"""Products and norms of vectors that implicit steps take in every iteration.

scipy and numpy check their operands anew each time, which takes longer than the work itself for a
short pillar. Sums have scipy's order, so results are bit-identical.
"""

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from continuum.model import Interfaces
from joints.formula import formula
from numerics.jit import jitted


class Matrix(csr_matrix):
    """A sparse matrix whose products with vectors are compiled."""

    def __matmul__(self, other: Any) -> Any:
        """Return the product with a vector, or what scipy returns for anything else."""
        rows, columns = self._shape  # scipy's property makes a tuple of numbers first
        if type(other) is not np.ndarray or other.ndim != 1 or other.size != columns:
            return super().__matmul__(other)
        product = np.empty(rows)
        multiply(self.indptr, self.indices, self.data, np.ascontiguousarray(other), product)
        return product


@jitted
def multiply(start, column, value, x, product):
    """Set the product of a matrix (CSR) and a vector."""
    for i in range(product.size):
        product[i] = row_times(start, column, value, x, i)


@formula
def row_times(start, column, value, x, i):
    """Return the product of a row of a matrix (CSR) and a vector."""
    total = 0.0
    for k in range(start[i], start[i + 1]):
        total += value[k] * x[column[k]]
    return total


@jitted
def largest(values):
    """Return the largest magnitude of an array [n], 0 if it is empty, NaN if any is NaN."""
    found = 0.0
    for value in values:
        found = larger(found, value)
    return found


@formula
def larger(found, value):
    """Return the larger of a magnitude and that of a value, NaN if any is NaN."""
    size = abs(value)
    return size if size > found or size != size else found


@jitted
def move_free(free, moved, old_u, old_v, drift, kept, dt, gamma, square, weight, a, u, v):
    """Set acceleration, displacement and velocity [n] of free freedoms [k] that have moved by so
    much in a step; square : beta dt^2. Return the largest displacement times its weight [k]."""
    found = 0.0
    for k in range(free.size):
        i = free[k]
        a[i] = (moved[k] - drift[i]) / square
        u[i] = old_u[i] + moved[k]
        v[i] = old_v[i] + dt * (kept[i] + gamma * a[i])
        found = larger(found, weight[k] * u[i])
    return found


@jitted
def out_of_balance(start, column, value, a, force, before, of_force, of_inertia, rest):
    """Set the forces that are out of balance with inertia, of a mass (CSR), and return the largest
    inertia; shares of both count, beside what the beginning of the step adds."""
    found = 0.0
    for i in range(rest.size):
        inertia = row_times(start, column, value, a, i)
        rest[i] = of_force * force[i] + before[i] - of_inertia * inertia
        found = larger(found, inertia)
    return found


@jitted
def rock_forces(start, column, value, u, force):
    """Set the forces of rock of a stiffness (CSR), and return the largest."""
    found = 0.0
    for i in range(force.size):
        force[i] = -row_times(start, column, value, u, i)
        found = larger(found, force[i])
    return found


@jitted
def mean_velocity(u, before, dt, mean):
    """Set the mean velocity between two displacements a time dt apart."""
    for i in range(mean.size):
        mean[i] = (u[i] - before[i]) / dt


def compiled_joints(interfaces: Interfaces | None) -> Interfaces | None:
    """Return joints whose operators have compiled products."""
    if interfaces is None:
        return None
    return interfaces._replace(jump=Matrix(interfaces.jump), spread=Matrix(interfaces.spread))
