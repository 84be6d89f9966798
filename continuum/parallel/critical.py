"""The critical step of rock shared by several processes, found by the first of them.

It stores motions of the whole rock, which need little memory, and no more of the operators than the
others: all multiply their shares by the vectors it sends. The search is that of a single process,
from the same motion, so that the step does not depend on the number of processes.
"""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator

from jointwave.continuum.explicit.critical import critical_step
from jointwave.continuum.parallel.communicator import Communicator

STOP = -1.0


def shared_critical_step(
    communicator: Communicator,
    mass: np.ndarray,
    stiffness: csr_matrix,
    viscosity: csr_matrix | None,
    fixed: np.ndarray,
    start: np.ndarray,
) -> float:
    """Return the critical step (s), the same number on every process.

    The parameters are those of `critical_time_step`; mass and matrices are this process's shares.
    """
    moves, motion = np.zeros(mass.size), np.zeros(mass.size)
    moves[np.setdiff1d(communicator.mine, fixed)] = 1.0
    motion[communicator.mine] = start[communicator.mine]
    damped = not communicator.all(viscosity is None)
    matrices = [stiffness, viscosity] if damped else [stiffness]
    mass, moves, motion = (communicator.on_first(share) for share in (mass, moves, motion))
    if communicator.rank:
        _serve(communicator, matrices)
        return communicator.comm.bcast(None)
    scale = moves / np.sqrt(mass)
    k, *c = (_whole(communicator, matrices, which, scale) for which in range(len(matrices)))
    try:
        found = critical_step(k, c[0] if c else None, motion)
    finally:
        communicator.comm.Bcast(np.full(scale.size + 1, STOP))
    return communicator.comm.bcast(found)


def _whole(
    communicator: Communicator, matrices: list, which: int, scale: np.ndarray
) -> LinearOperator:
    """Return an operator of the whole rock, scaled on both sides; first process only."""

    def product(x: np.ndarray) -> np.ndarray:
        message = np.append(scale * x.ravel(), which)
        communicator.comm.Bcast(message)
        return scale * _multiplied(communicator, matrices[which], message[:-1])

    return LinearOperator((scale.size, scale.size), product, dtype=float)


def _serve(communicator: Communicator, matrices: list) -> None:
    """Multiply the vectors that the first process sends until it stops."""
    message = np.empty(communicator.degrees_of_freedom + 1)
    while True:
        communicator.comm.Bcast(message)
        if message[-1] == STOP:
            return
        _multiplied(communicator, matrices[int(message[-1])], message[:-1])


def _multiplied(
    communicator: Communicator, matrix: csr_matrix | None, motion: np.ndarray
) -> np.ndarray:
    """Return the product with a motion of the whole rock, on the first process."""
    x = np.zeros(communicator.length)
    x[communicator.freedom] = motion[communicator.number[communicator.freedom]]
    return communicator.on_first(np.zeros(x.size) if matrix is None else matrix @ x)
