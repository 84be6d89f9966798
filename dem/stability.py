"""The critical step of a rock mass of rigid blocks.

The critical step, with dashpots and what holds the sides, follows from a bound block by block, on
stiffness and damping together. The energy of a spring between two blocks, k (a - b)^2, is at most
2 k a^2 + 2 k b^2, so that the stiffness matrix is at most twice its own diagonal blocks K_i, each
that of block i with its neighbours held:

    max_i lambda(K_i, M_i)  <=  omega^2  <=  2 max_i lambda(K_i, M_i).

The lower bound is the motion of one block alone. The step that follows from the upper one is thus
never above the critical step and at most 30 % below it; in a square lattice where translation is
fastest it is equal to it.

Slip and opening only take stiffness away; joints that stiffen are as stiff as in the stiffest state
in reach, and joints that dilate as in `joints.dilation.riding_stiffness`. Dashpots of quiet sides
take the mean velocity of a step and change no bound, nor does mass-proportional damping; local
damping alpha makes forces that turn a velocity round 1 + alpha times as large.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwave.dem.columns import Columns
from jointwave.dem.contacts import Contacts, jumps_of, springs_of
from jointwave.numerics.critical_step import critical_step


def critical_time_step(
    contacts: Contacts, columns: Columns, masses: np.ndarray, local: float
) -> float:
    """Return a lower bound of the critical step, s; masses : matrices of the blocks [N, F, F].
    local : Cundall's damping."""
    eta = columns.time_constants
    own, damping = _stiffness(contacts, columns, tuple(columns.stiffest), masses), None
    if eta is not None:
        viscosity = eta[0] * columns.normal, eta[1] * columns.shear
        damping = _stiffness(contacts, columns, viscosity, masses)

    def largest(a: float, b: float) -> float:
        both = a * own if damping is None else a * own + b * damping
        return (1 + local) * float(_highest(both, masses).max())

    return critical_step(largest, damping is not None)


def squared_frequencies(contacts: Contacts, columns: Columns, masses: np.ndarray) -> np.ndarray:
    """Return the bound of each block on the square of the largest frequency [N], 1/s2."""
    return _highest(_stiffness(contacts, columns, tuple(columns.stiffest), masses), masses)


def _highest(matrices: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Return twice the largest eigenvalue of each block's matrix [N, F, F] over its inertia."""
    back = np.linalg.inv(np.linalg.cholesky(masses))
    return 2 * np.linalg.eigvalsh(back @ matrices @ back.swapaxes(1, 2))[:, -1]


def _stiffness(
    contacts: Contacts, columns: Columns, values: Sequence[np.ndarray], masses: np.ndarray
) -> np.ndarray:
    """Return the matrix of each block against what it touches [N, F, F], of stiffness or viscosity
    per area in each column, normal and in shear, with the second moments of its points."""
    count, freedoms, _ = masses.shape
    dim = contacts.frame.shape[1]
    spread = columns.bending[contacts.column, None, None] * contacts.spread
    normal, shear = (x[contacts.column] for x in values)
    springs = springs_of(normal, shear, contacts.area, spread, freedoms - dim)
    found = np.zeros((count, freedoms, freedoms))
    for side in (0, 1):
        own = contacts.blocks[:, side]
        real = own < count
        jump = jumps_of(contacts.frame[real], contacts.arm[real, side], freedoms - dim)
        np.add.at(found, own[real], jump.swapaxes(1, 2) @ springs[real] @ jump)
    return found
