"""The critical step of rock that several processes share, found by the first of them.

That one holds motions of the whole rock, which take little room, and no more of the operators than
the others: all multiply their shares by what it sends them. The search is that of a process alone,
from the same motion, so that the step is the same however many share the rock.
"""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator

from continuum.explicit.critical import critical_step
from continuum.parallel.communicator import Team

STOP = -1.0


def shared_critical_step(
    team: Team,
    mass: np.ndarray,
    stiffness: csr_matrix,
    viscosity: csr_matrix | None,
    fixed: np.ndarray,
    start: np.ndarray,
) -> float:
    """Return the critical step (s), the same number on every process.

    The parameters are those of `critical_time_step`, mass and matrices a process's shares.
    """
    moves, motion = np.zeros(mass.size), np.zeros(mass.size)
    moves[np.setdiff1d(team.mine, fixed)] = 1.0
    motion[team.mine] = start[team.mine]
    damped = not team.all(viscosity is None)
    matrices = [stiffness, viscosity] if damped else [stiffness]
    mass, moves, motion = (team.on_first(share) for share in (mass, moves, motion))
    if team.rank:
        _serve(team, matrices)
        return team.comm.bcast(None)
    scale = moves / np.sqrt(mass)
    k, *c = (_whole(team, matrices, which, scale) for which in range(len(matrices)))
    try:
        found = critical_step(k, c[0] if c else None, motion)
    finally:
        team.comm.Bcast(np.full(scale.size + 1, STOP))
    return team.comm.bcast(found)


def _whole(team: Team, matrices: list, which: int, scale: np.ndarray) -> LinearOperator:
    """Return one of the operators of the whole rock, scaled on both sides; first process alone."""

    def product(x: np.ndarray) -> np.ndarray:
        message = np.append(scale * x.ravel(), which)
        team.comm.Bcast(message)
        return scale * _multiplied(team, matrices[which], message[:-1])

    return LinearOperator((scale.size, scale.size), product, dtype=float)


def _serve(team: Team, matrices: list) -> None:
    """Multiply what the first process sends until it stops."""
    message = np.empty(team.degrees_of_freedom + 1)
    while True:
        team.comm.Bcast(message)
        if message[-1] == STOP:
            return
        _multiplied(team, matrices[int(message[-1])], message[:-1])


def _multiplied(team: Team, matrix: csr_matrix | None, motion: np.ndarray) -> np.ndarray:
    """Return the product with a motion of the whole rock, on the first process."""
    x = np.zeros(team.length)
    x[team.freedom] = motion[team.number[team.freedom]]
    return team.on_first(np.zeros(x.size) if matrix is None else matrix @ x)
