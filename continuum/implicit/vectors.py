"""Compiled sums and products of vectors of freedoms in implicit steps.

numpy and scipy check their operands in every product and sum, which takes longer than the work
itself for a short pillar.
"""

from typing import NamedTuple

import numpy as np

from jointwave.joints.formula import formula
from jointwave.numerics.arguments import unpacked
from jointwave.numerics.jit import jitted


class Vectors(NamedTuple):
    """What steps of one length go through; [n] of all freedoms, [k] of those that move.

    free : int array [k]. moved [k], m, by how much each moves in the trial; weight [k], N/m, what
        its last digits weigh. old_u, old_v, old_a, old_force [n] : at the beginning of the step.
    drift, kept, before [n] : what `predict` makes of it for all trials: m, m/s2, N.
    u, v, a, force [n] : of the trial. rest [n] : what is out of balance, N.
    start, column, value : the mass (CSR), kg. The rest as in `generalised_alpha`; dt, s.
    """

    free: np.ndarray
    moved: np.ndarray
    weight: np.ndarray
    old_u: np.ndarray
    old_v: np.ndarray
    old_a: np.ndarray
    old_force: np.ndarray
    drift: np.ndarray
    kept: np.ndarray
    before: np.ndarray
    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    force: np.ndarray
    rest: np.ndarray
    start: np.ndarray
    column: np.ndarray
    value: np.ndarray
    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    dt: float


@formula
def row_times(start, column, value, x, i):
    """Return the product of a row of a matrix (CSR) and a vector."""
    total = 0.0
    for k in range(start[i], start[i + 1]):
        total += value[k] * x[column[k]]
    return total


@formula
def add_transposed(start, column, value, x, product):
    """Add the product of a transposed matrix (CSR before) and a vector."""
    for i in range(x.size):
        for k in range(start[i], start[i + 1]):
            product[column[k]] += value[k] * x[i]


@formula
def larger(found, value):
    """Return the larger of a magnitude and that of a value, NaN if any is NaN."""
    size = abs(value)
    return size if size > found or size != size else found


@jitted
def largest(values):
    """Return the largest magnitude of an array [n], 0 if it is empty, NaN if any is NaN."""
    found = 0.0
    for value in values:
        found = larger(found, value)
    return found


@jitted
def differ(one, other):
    """Return how many numbers of two arrays [n] differ."""
    count = 0
    for i in range(one.size):
        count += one[i] != other[i]
    return count


@jitted
def predict(given):
    """Set what no trial of a step changes, and where the first one moves to."""
    (s,) = unpacked(given)
    square = s.dt**2
    for i in range(s.old_a.size):
        inertia = row_times(s.start, s.column, s.value, s.old_a, i)
        s.kept[i] = (1.0 - s.gamma) * s.old_a[i]
        s.drift[i] = s.dt * s.old_v[i] + (0.5 - s.beta) * square * s.old_a[i]
        s.before[i] = s.alpha_f * s.old_force[i] - s.alpha_m * inertia
    for k in range(s.free.size):
        s.moved[k] = s.drift[s.free[k]] + s.beta * square * s.old_a[s.free[k]]


@jitted
def move_free(given):
    """Set acceleration, displacement and velocity of the freedoms that move; return the largest
    displacement times its weight, N."""
    (s,) = unpacked(given)
    found, square = 0.0, s.beta * s.dt**2
    for k in range(s.free.size):
        i = s.free[k]
        s.a[i] = (s.moved[k] - s.drift[i]) / square
        s.u[i] = s.old_u[i] + s.moved[k]
        s.v[i] = s.old_v[i] + s.dt * (s.kept[i] + s.gamma * s.a[i])
        found = larger(found, s.weight[k] * s.u[i])
    return found


@jitted
def out_of_balance(given):
    """Set the forces that are out of balance with inertia, and return the largest inertia; shares
    of both count, beside what the beginning of the step adds."""
    (s,) = unpacked(given)
    found = 0.0
    for i in range(s.rest.size):
        inertia = row_times(s.start, s.column, s.value, s.a, i)
        s.rest[i] = (1.0 - s.alpha_f) * s.force[i] + s.before[i] - (1.0 - s.alpha_m) * inertia
        found = larger(found, inertia)
    return found
