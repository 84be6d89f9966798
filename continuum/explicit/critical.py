"""The critical step of the assembled rock with its joints and dashpots."""

from math import sqrt

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import eigsh

from jointwave.continuum.space.body import Body
from jointwave.continuum.space.evaluation import on_freedoms

FEW = 200  # degrees of freedom up to which the dense solver is the quicker one

#: Of the iterative solver, relative. The eigenvalue is added its residual, which bounds its error:
#: the step is never above the critical one, and half of this below it at most.
RESIDUAL = 2e-4
SETTLED = 1e-6  # relative change of the step that ends the search
ROUNDS = 20


def critical_time_step(
    mass: np.ndarray,
    stiffness: csr_matrix,
    viscosity: csr_matrix | None = None,
    fixed: np.ndarray | None = None,
    start: np.ndarray | None = None,
) -> float:
    """Return the critical step (s) of leapfrog for the assembled operators.

    With dashpots that see the rate extrapolated to the centre of the step, it is critical when the
    largest eigenvalue of M^-1 (dt^2 K + 4 dt C) is 4 (`numerics.critical_step`). For the
    eigenvector x of one step this is a quadratic equation for the next: Rayleigh's quotient is
    stationary, so the steps converge quadratically. Quiet ends are centred implicitly and do not
    bound the step; no tension only softens, and so does what slides or breaks.

    Parameters
    ----------
    mass : float array [n], kg.
    stiffness : [n, n], N/m, rock and joints; freedoms without any are padding.
    viscosity : [n, n], N s/m, rock and joints; None without dashpots.
    fixed : int array, freedoms that do not move.
    start : float array [n], any motion that the search may begin with.
    """
    moves = stiffness.diagonal() > 0
    moves[[] if fixed is None else fixed] = False
    moving = np.flatnonzero(moves)
    scale = diags(1 / np.sqrt(mass[moving]))
    k, c = (
        None if matrix is None else csr_matrix(scale @ matrix[moving][:, moving] @ scale)
        for matrix in (stiffness, viscosity)
    )
    if start is None:
        start = np.random.default_rng(0).standard_normal(mass.size)
    return critical_step(k, c, start[moving])


def critical_step(k, c, start: np.ndarray) -> float:
    """Return the critical step (s) of M^-1/2 K M^-1/2 and M^-1/2 C M^-1/2, c None without dashpots.

    k, c : [n, n], anything that multiplies. start : float array [n], any motion.
    """
    mode, error = _highest_mode(k, start)
    dt = 2 / sqrt(float(mode @ (k @ mode)) + error)
    if c is None:
        return dt
    for _ in range(ROUNDS):
        mode, error = _highest_mode(dt**2 * k + 4 * dt * c, mode)
        elastic, viscous = float(mode @ (k @ mode)) + error / dt**2, float(mode @ (c @ mode))
        # Of elastic dt^2 + 4 viscous dt = 4, in a form without cancellation for strong dashpots.
        found = 2 / (viscous + sqrt(viscous**2 + elastic))
        if abs(found - dt) <= SETTLED * dt:
            return found
        dt = found
    return dt


def any_motion(body: Body) -> np.ndarray:
    """Return a motion [n] that has something of every mode, the same however many processes share
    the body: what is found from it differs by no more than round-off."""
    random, (count, nodes) = np.random.default_rng(0), body.cells.shape
    shape = random.standard_normal((nodes, body.section.components))
    size = random.standard_normal(count)
    found = on_freedoms(body, np.arange(count), size[None, :, None, None] * shape)
    return body.communicator.total(found[0])


def _highest_mode(matrix, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the eigenvector of the largest eigenvalue and a bound on the eigenvalue's error."""
    size = matrix.shape[0]
    if size <= FEW:
        _, vectors = eigh(matrix @ np.eye(size), subset_by_index=[size - 1, size - 1])
        return vectors[:, 0], 0.0
    value, vectors = eigsh(matrix, 1, which="LA", v0=start, tol=RESIDUAL, maxiter=100_000)
    mode = vectors[:, 0]
    return mode, float(np.linalg.norm(matrix @ mode - value[0] * mode))
