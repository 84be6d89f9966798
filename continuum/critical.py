"""The critical step of the assembled bar with its joints and dashpots."""

import numpy as np
from scipy.linalg import eigvalsh
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import eigsh

from joints.stability import critical_step

FEW = 64  # degrees of freedom up to which the dense solver is the quicker one
RESIDUAL = 1e-9  # of the iterative solver, relative; bounds the eigenvalue's error


def critical_bar_step(
    mass: np.ndarray,
    stiffness: csr_matrix,
    viscosity: csr_matrix | None = None,
    fixed: np.ndarray | None = None,
) -> float:
    """Return the critical step (s) of leapfrog, exact for the assembled operators.

    Quiet ends are centred implicitly and do not bound the step; no tension only softens.

    Parameters
    ----------
    mass : float array [n], kg.
    stiffness : [n, n], N/m, rock and joints.
    viscosity : [n, n], N s/m, rock and joints; None without dashpots.
    fixed : int array, nodes that do not move.
    """
    moving = np.delete(np.arange(mass.size), [] if fixed is None else fixed)
    scale = diags(1 / np.sqrt(mass[moving]))
    k = scale @ stiffness[moving][:, moving] @ scale
    c = 0 * k if viscosity is None else scale @ viscosity[moving][:, moving] @ scale
    # A start of its own keeps the result reproducible; the last vector makes the next one quick.
    start = np.random.default_rng(0).standard_normal(moving.size)

    def largest(a: float, b: float) -> float:
        matrix = csr_matrix(a * k + b * c)
        if moving.size <= FEW:
            return float(eigvalsh(matrix.toarray())[-1])
        value, vector = eigsh(matrix, 1, which="LA", v0=start, tol=RESIDUAL, maxiter=100_000)
        start[:] = vector[:, 0]
        return float(value[0])

    return critical_step(largest, viscosity is not None)
