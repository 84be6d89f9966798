"""Bounds of a row of blocks in space: its critical step, and how fast its blocks can become.

The critical step follows from the assembled stiffness and damping.

With T(h) the velocity of a face at the lever h, a joint's relative motion is T(h) w2 - T(-h) w1 of
its two blocks, and K = B^T D B with a row of B for each component. Slip and opening only take
stiffness away, so the row with all joints intact bounds every state that it can reach. Local
damping alpha makes forces that turn a velocity round, at every step in the mode that alternates,
1 + alpha times as large.
"""

from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.linalg import LinAlgError, cholesky_banded

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial.stability import shaking
from jointwave.dem.spatial.ends import Face, end_springs, face_stiffness, lever_matrix
from jointwave.dem.spatial.layout import STRIDE, unpacked
from jointwave.dem.spatial.model import RowModel, RowState
from jointwave.joints.dilation import riding_stiffness
from jointwave.numerics.critical_step import critical_step
from jointwave.numerics.divergence import speed_that

ENOUGH_BLOCKS = 2000  # of alike joints: no longer row has an eigenvalue larger by 1e-6
CLOSE_ENOUGH = 1e-12  # relative, to the largest eigenvalue


def critical_spatial_step(p: Properties, face: Face, ends: tuple[str, str], turns: bool) -> float:
    """Return the critical step (s): from M^-1/2 (a K + b C) M^-1/2 with all dashpots, joints that
    dilate as stiff as in `joints.dilation.riding_stiffness`."""
    if p.dilation is not None:
        normal, shear = riding_stiffness(p.dilation, p.friction, p.stiffness, p.shear_stiffness)
        p = replace(p, stiffness=normal, shear_stiffness=shear)
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
    for kind, lever, at in ((ends[0], start, 0), (ends[1], end, count - 1)):
        block = slice(size * at, size * (at + 1))
        held = face_stiffness(kind, end_springs(kind, p, face, size))
        outer[block, block] += lever.T @ np.diag(held) @ lever
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


def highest_speeds(
    scene: Scene, p: Properties, model: RowModel, state: RowState, time: Clock
) -> np.ndarray:
    """Return a bound on each component of the velocity of any block [freedoms], m/s and rad/s; with
    finite rotations kg m2/s for the angular momentum."""
    inertia = model.block.inertia[: model.form.freedoms]
    with np.errstate(over="ignore"):
        bound = np.sqrt(p.block_mass / inertia) * _speed(scene, p, model, state, time, inertia)
        if model.form.finite:
            bound[3:] = inertia[3:].max() * bound[3:].max()
    return bound


def _speed(
    scene: Scene, p: Properties, model: RowModel, state: RowState, time: Clock, inertia: np.ndarray
) -> float:
    """Return the bound for a block's velocity, m/s."""
    m, duration = p.block_mass, time.dt * (time.steps + time.stride)
    weight = model.block.weight[:3]
    lever = lever_matrix(model.block.arm if model.form.turns else None, inertia.size)
    push = np.linalg.norm(lever.T @ model.load.direction / np.sqrt(m * inertia))
    return speed_that(
        time.dt * (np.abs(model.load.stress) * push).sum(),
        duration * _steady(scene, p) / m,
        duration * np.sqrt(p.block_count) * np.linalg.norm(weight) / m,
        np.sqrt(p.block_count) * shaking(model.load.base, time.dt),
        _stored(scene, p, model, state, weight) / np.sqrt(m),
    )


def _steady(scene: Scene, p: Properties) -> float:
    """Return what a prestress presses on ends that give way, N."""
    if scene.prestress is None:
        return 0.0
    return 2 * abs(scene.prestress.normal) * p.area


def _stored(
    scene: Scene, p: Properties, model: RowModel, state: RowState, weight: np.ndarray
) -> float:
    """Return a bound on the root of twice the energy stored at the start, sqrt(J).

    Of a prestress that of all springs; of a static state under gravity at most what the weight has
    done on its way there. The roots add up, for the energy is a norm of the displacement.
    """
    moved = unpacked(state.motion, STRIDE, p.block_count)[:3].sum(axis=1)
    stored = np.sqrt(2 * np.abs(weight * moved).sum())
    if scene.prestress is None:
        return float(stored)
    softness = (1 / p.stiffness).sum() + 1 / p.regular_stiffness  # the ends' springs as well
    return float(stored + abs(scene.prestress.normal) * np.sqrt(p.area * softness))
