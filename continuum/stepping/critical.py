"""The critical step of leapfrog for an assembled body."""

from math import sqrt

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import eigsh

FEW = 200  # freedoms up to which the dense solver is faster
RESIDUAL = 2e-4  # relative, of the iterative solver; the residual is added to the eigenvalue
SETTLED = 1e-6  # convergence: relative change of the step
ROUNDS = 20


def critical_step(
    mass: np.ndarray,
    stiffness: csr_matrix,
    viscosity: csr_matrix,
    fixed: np.ndarray,
    start: np.ndarray | None = None,
) -> float:
    """Return the critical step, s, of rock and joints together.

    With dashpots at extrapolated rates the step is critical when the largest eigenvalue of
    M^-1 (dt^2 K + 4 dt C) is 4 (`numerics.critical_step`). For the eigenvector of one step this is
    a quadratic equation for the next step; the iteration converges quadratically, since Rayleigh's
    quotient is stationary. Quiet sides do not bound the step.

    mass : [n], kg. stiffness : N/m. viscosity : N s/m, without entries if absent. fixed : freedoms
    with prescribed motion. start : start vector of the eigenvalue solver [n].
    """
    moving = np.setdiff1d(np.flatnonzero(stiffness.diagonal() > 0), fixed)
    scale = diags(1 / np.sqrt(mass[moving]))

    def scaled(matrix: csr_matrix) -> csr_matrix:
        return csr_matrix(scale @ matrix[moving][:, moving] @ scale)

    k = scaled(stiffness)
    if start is None:
        start = np.random.default_rng(0).standard_normal(mass.size)
    mode, error = highest_mode(k, start[moving])
    dt = 2 / sqrt(float(mode @ (k @ mode)) + error)
    if not viscosity.nnz:
        return dt
    c = scaled(viscosity)
    for _ in range(ROUNDS):
        mode, error = highest_mode(dt**2 * k + 4 * dt * c, mode)
        elastic, viscous = float(mode @ (k @ mode)) + error / dt**2, float(mode @ (c @ mode))
        found = 2 / (viscous + sqrt(viscous**2 + elastic))
        if abs(found - dt) <= SETTLED * dt:
            return found
        dt = found
    return dt


def highest_mode(matrix, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the eigenvector of the largest eigenvalue, and a bound on the eigenvalue's error."""
    size = matrix.shape[0]
    if size <= FEW:
        return eigh(matrix.toarray(), subset_by_index=[size - 1, size - 1])[1][:, 0], 0.0
    value, vectors = eigsh(matrix, 1, which="LA", v0=start, tol=RESIDUAL, maxiter=100_000)
    mode = vectors[:, 0]
    return mode, float(np.linalg.norm(matrix @ mode - value[0] * mode))
