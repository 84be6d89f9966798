"""The critical step of a row of blocks in space, from its assembled stiffness and damping.

With T(h) the velocity of a face at the lever h, a joint's relative motion is T(h) w2 - T(-h) w1 of
its two blocks, and K = B^T D B with a row of B for each component. Slip and opening only take
stiffness away, so the row with all joints intact bounds every state that it can reach. Local
damping alpha makes forces that turn a velocity round, at every step in the mode that alternates,
1 + alpha times as large.
"""

import numpy as np
from scipy import sparse
from scipy.linalg import LinAlgError, cholesky_banded

from cases.material.calibrate import Properties
from dem.spatial.ends import end_springs, face_stiffness, lever_matrix
from dem.spatial.section import Face
from joints.stability import critical_step

ENOUGH_BLOCKS = 2000  # of alike joints: no longer row has an eigenvalue larger by 1e-6
CLOSE_ENOUGH = 1e-12  # relative, to the largest eigenvalue


def critical_spatial_step(p: Properties, face: Face, ends: tuple[str, str], turns: bool) -> float:
    """Return the critical step (s): from M^-1/2 (a K + b C) M^-1/2 with all dashpots."""
    alike = (p.stiffness == p.stiffness[0]).all() and (
        p.shear_stiffness == p.shear_stiffness[0]
    ).all()
    same = (
        p.joint_time_constant is None or (p.joint_time_constant == p.joint_time_constant[0]).all()
    )
    count = min(p.block_count, ENOUGH_BLOCKS) if alike and same else p.block_count
    relative, springs, outer = _assembled(p, face, ends, turns, count)
    eta = (
        np.zeros(count - 1) if p.joint_time_constant is None else p.joint_time_constant[: count - 1]
    )
    etas = np.repeat(eta, springs.size // (count - 1))

    def largest(a: float, b: float) -> float:
        stiffness = relative.T @ sparse.diags(springs * (a + b * etas)) @ relative + a * outer
        return (1 + (p.local_damping or 0.0)) * _largest_eigenvalue(stiffness.tocsr())

    return critical_step(largest, p.joint_time_constant is not None)


def _assembled(
    p: Properties, face: Face, ends: tuple[str, str], turns: bool, count: int
) -> tuple[sparse.spmatrix, np.ndarray, sparse.spmatrix]:
    """Return B M^-1/2, the joints' springs in its rows, and the ends' share of M^-1/2 K M^-1/2."""
    size, arm = (6, p.spacing / 2) if turns else (3, None)
    inertia = [p.block_mass] * 3 + [p.inertia_across, p.inertia_along, p.inertia_across]
    scale = np.diag(1 / np.sqrt(inertia[:size]))
    start, end = lever_matrix(arm, size) @ scale, lever_matrix(arm and -arm, size) @ scale
    left, right = sparse.eye(count - 1, count), sparse.eye(count - 1, count, k=1)
    relative = sparse.kron(right, start) - sparse.kron(left, end)
    springs = (
        p.stiffness[: count - 1, None] * face.normal
        + p.shear_stiffness[: count - 1, None] * face.shear
    )
    outer = sparse.lil_matrix((size * count, size * count))
    held = end_springs(p, face, size)
    for kind, lever, at in ((ends[0], start, 0), (ends[1], end, count - 1)):
        block = slice(size * at, size * (at + 1))
        outer[block, block] += lever.T @ np.diag(face_stiffness(kind, held)) @ lever
    return relative.tocsr(), springs[:, :size].ravel(), outer.tocsr()


def _largest_eigenvalue(matrix: sparse.csr_matrix) -> float:
    """Bisect for the shift that makes s - K positive definite, which its band's Cholesky tells.

    A long row has its largest eigenvalues so close together that Lanczos takes minutes.
    """
    lower = sparse.tril(matrix).tocoo()
    band = np.zeros(((lower.row - lower.col).max() + 1, matrix.shape[0]))
    band[lower.row - lower.col, lower.col] = -lower.data
    low, high = matrix.diagonal().max(), abs(matrix).sum(axis=1).max()
    while high - low > CLOSE_ENOUGH * high:
        shift = (low + high) / 2
        shifted = band.copy()
        shifted[0] += shift
        try:
            cholesky_banded(shifted, overwrite_ab=True, lower=True, check_finite=False)
            high = shift
        except LinAlgError:
            low = shift
    return float(high)
