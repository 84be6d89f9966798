"""The critical time step of rigid blocks.

A bound on stiffness and damping, block by block, gives the step. The energy of a spring between two
blocks, k (a - b)^2, is at most 2 k a^2 + 2 k b^2. So the stiffness matrix is at most twice its
diagonal blocks K_i, where K_i is the stiffness of block i with its neighbours held:

    max_i lambda(K_i, M_i)  <=  omega^2  <=  2 max_i lambda(K_i, M_i).

The lower bound is the motion of one block alone. So the step of the upper bound is never above the
critical step and at most 30 % below it, and equal to it in a square lattice without rotation.

Slip and opening only reduce stiffness. Joints that stiffen have the stiffness of the stiffest state
in reach, dilatant joints that of `joints.dilation.riding_stiffness`. Dashpots of quiet sides act on
the mean velocity of a step and do not change the bound, nor does mass-proportional damping. Local
damping alpha makes forces that reverse a velocity 1 + alpha times as large.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, cholesky_banded

from jointwave.dem.contacts.faces import Contacts, jumps_of, springs_of
from jointwave.dem.contacts.law import Columns
from jointwave.dem.sides.surroundings import EndSpring
from jointwave.numerics.critical_step import critical_step

ENOUGH_BLOCKS = 2000  # of a row of equal blocks, for its critical step
ALIKE = 1e-9  # relative difference of masses of equal blocks
CLOSE_ENOUGH = 1e-14  # relative error of the largest eigenvalue


def critical_time_step(
    contacts: Contacts,
    columns: Columns,
    masses: np.ndarray,
    local: float,
    springs: Sequence[EndSpring] | None = None,
) -> float:
    """Return a lower bound of the critical step, s; of blocks in a row the step itself.

    masses : matrices of the blocks [N, F, F]. local : Cundall's damping. springs : at the ends of a
    row; None for blocks that are not in a row.
    """
    damping, back = np.zeros(1), np.zeros(0)
    if springs is not None:
        contacts, masses = begin_of(contacts, columns, masses)
        back = np.linalg.inv(np.linalg.cholesky(masses))

    def matrices(values: Iterable[np.ndarray], held: float) -> np.ndarray:
        found = _stiffness(contacts, columns, values, masses)
        if springs is None:
            return found[0]
        for one in springs:
            found[0, min(one.block, len(masses) - 1)] += held * one.critical
        found[0] = back @ found[0] @ back.swapaxes(1, 2)
        found[1, :-1] = back[1:] @ found[1, :-1] @ back[:-1].swapaxes(1, 2)
        return lower_band(found)

    own = matrices(columns.stiffest, 1.0)
    if columns.viscosity is not None:
        damping = matrices(columns.viscosity, 0.0)

    def largest(a: float, b: float) -> float:
        both = a * own + b * damping
        highest = (
            float(_highest(both, masses).max()) if springs is None else largest_eigenvalue(both)
        )
        return (1 + local) * highest

    return critical_step(largest, columns.viscosity is not None)


def squared_frequencies(
    contacts: Contacts, columns: Columns, masses: np.ndarray, held: Any = 0.0
) -> np.ndarray:
    """Return each block's bound on the square of the largest angular frequency [N], 1/s2.

    held : stiffness of springs between each block and the ground [N, F, F].
    """
    own = _stiffness(contacts, columns, columns.stiffest, masses)[0]
    return _highest(own + held, masses)


def _highest(matrices: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """Return twice the largest eigenvalue of M^-1 K for each block, both [N, F, F]."""
    back = np.linalg.inv(np.linalg.cholesky(masses))
    return 2 * np.linalg.eigvalsh(back @ matrices @ back.swapaxes(1, 2))[:, -1]


def _stiffness(
    contacts: Contacts, columns: Columns, values: Iterable[np.ndarray], masses: np.ndarray
) -> np.ndarray:
    """Return diagonal blocks of the stiffness or damping, and of a row those below [2, N, F, F].

    values : stiffness or viscosity per area of each column, normal and in shear.
    """
    rotations = masses.shape[1] - contacts.frame.shape[1]
    spread = columns.bending[contacts.column, None, None] * contacts.spread
    normal, shear = (x[contacts.column] for x in values)
    springs = springs_of(normal, shear, contacts.area, spread, rotations)
    found, (i, j) = np.zeros((2, *masses.shape)), contacts.blocks.T
    of_i, of_j = (jumps_of(contacts.frame, arm, rotations) for arm in contacts.arm.swapaxes(0, 1))
    inner = j < len(masses)
    np.add.at(found[0], i, of_i.swapaxes(1, 2) @ springs @ of_i)
    np.add.at(found[0], j[inner], (of_j.swapaxes(1, 2) @ springs @ of_j)[inner])
    found[1, i[inner]] = -(of_j.swapaxes(1, 2) @ springs @ of_i)[inner]
    return found


def begin_of(
    contacts: Contacts, columns: Columns, masses: np.ndarray
) -> tuple[Contacts, np.ndarray]:
    """Return contacts and masses of a shorter row with the same critical step: of equal blocks and
    joints, the first ENOUGH_BLOCKS; the largest eigenvalue of a longer row is within 1e-6."""
    count, joints = len(masses), len(masses) - 1
    values = [*columns.stiffest, *([] if columns.viscosity is None else columns.viscosity)]
    alike = all((one[:joints] == one[0]).all() for one in values)
    if (
        not alike
        or not np.allclose(masses, masses[0], rtol=ALIKE, atol=0)
        or count <= ENOUGH_BLOCKS
    ):
        return contacts, masses
    last, few = ENOUGH_BLOCKS - 1, np.r_[: ENOUGH_BLOCKS - 1, joints : len(contacts.area)]
    pairs = np.minimum(contacts.blocks[few], [last, contacts.blocks.max()])
    pairs[last:, 1] -= count - ENOUGH_BLOCKS
    return contacts.some(few)._replace(blocks=pairs), masses[:ENOUGH_BLOCKS]


def lower_band(matrices: np.ndarray) -> np.ndarray:
    """Return a symmetric matrix's lower band [2 F, N F] from the blocks of `_stiffness`."""
    _, count, size, _ = matrices.shape
    found = np.zeros((2 * size, count, size))
    for below, block in enumerate(matrices):
        for row in range(size):
            for column in range(size):
                if (off := below * size + row - column) >= 0:
                    found[off, :, column] = block[:, row, column]
    return found.reshape(2 * size, -1)


def largest_eigenvalue(band: np.ndarray) -> float:
    """Return the largest eigenvalue of a symmetric matrix K, given its lower band, by bisection for
    the shift s from which s - K is positive definite.

    Lanczos takes minutes: the largest eigenvalues of a long row are close together.
    """
    whole = np.abs(band).sum(axis=0)
    for off in range(1, len(band)):
        whole[off:] += np.abs(band[off, :-off])
    low, high = float(band[0].max()), float(whole.max())
    while high - low > CLOSE_ENOUGH * high:
        shifted = -band
        shifted[0] += (low + high) / 2
        try:
            cholesky_banded(shifted, overwrite_ab=True, lower=True, check_finite=False)
            high = (low + high) / 2
        except LinAlgError:
            low = (low + high) / 2
    return high
