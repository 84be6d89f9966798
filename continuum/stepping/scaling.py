"""Mass scaling: added mass at the nodes of a few small cells that would limit the time step.

Slivers between joint planes have cells much smaller than the rest. A step dt is stable if

    sum_j |dt^2 K_ij + 4 dt C_ij| <= 4 m_i

for every freedom i, by Gershgorin's theorem on M^-1 (dt^2 K + 4 dt C) (`stepping.critical`). Mass
that a row lacks for a longer step is added, equally in each direction.

An added mass M in rock of density rho scatters about pi M / (rho l^d) of a wave of length l, at one
wavelength, in one, two and three dimensions, by the first term of Born's series. The sum of added
mass is at most `OF_ALL` of the rock, which scatters 3e-4 of a wave if small cells lie anywhere; and
at most `OF_PIECE` of a piece of rock between joints, a bound on the error of its acceleration.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from jointwave.continuum.stepping.problem import Problem

OF_ALL, OF_PIECE = 1e-4, 1e-2  # most added mass, over that of all rock, and of a piece
WORTH = 2.0  # least gain of the step for which mass is added
HALVINGS = 30  # of the range of steps, in the search for the longest


class Scaled(NamedTuple):
    """Mass for longer steps.

    mass : [freedoms], kg. nodes : number of nodes with added mass. share : added mass over all
    mass. before : upper bound of the critical step without added mass, s.
    """

    mass: np.ndarray
    nodes: int
    share: float
    before: float

    def gained(self, critical: float) -> str:
        """Return a message on the gain, given the new critical step, s."""
        return (
            f"{self.nodes:,} nodes of cells much smaller than the rest have more mass, "
            f"{self.share:.1g} of all rock: steps are at least {critical / self.before:.2g} "
            "times as long"
        )


def scaled_mass(problem: Problem) -> Scaled | None:
    """Return the scaled mass of a problem; None if the gain is too small."""
    body, matrices = problem.body, (problem.stiffness, problem.viscosity)
    mass = body.mass.reshape(-1, body.components)
    elastic, viscous = (_sums(problem, one, mass.shape) for one in matrices)
    piece = connected_components(body.stiffness, directed=False)[1]
    of_piece = np.bincount(piece, body.mass)

    def lacking(dt: float) -> np.ndarray:
        """Return the mass that each node lacks for a step [nodes], kg."""
        need = dt**2 / 4 * elastic + dt * viscous - mass
        return np.maximum(need, 0.0).max(axis=1)

    def is_little(dt: float) -> bool:
        added = np.repeat(lacking(dt), body.components)
        little = added.sum() <= OF_ALL * of_piece.sum()
        return bool(little and (np.bincount(piece, added) <= OF_PIECE * of_piece).all())

    steps = _longest(mass, elastic, viscous)
    low, high = float(steps.min()), float(np.median(steps))
    if not high > WORTH * low or not is_little(WORTH * low):
        return None
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if is_little(middle) else (low, middle)
    added = lacking(low)
    k, c = (one.diagonal() for one in matrices)
    before = float(_longest(mass.ravel(), k, c).min())
    share = float(added.sum() / mass[:, 0].sum())
    return Scaled((mass + added[:, None]).ravel(), int((added > 0).sum()), share, before)


def _sums(problem: Problem, matrix: csr_matrix, shape: tuple[int, ...]) -> np.ndarray:
    """Return the row sums of absolute values [nodes, d], 0 for prescribed motion."""
    found = np.asarray(abs(matrix).sum(axis=1)).reshape(shape)
    found.reshape(-1)[problem.held.freedom] = 0.0
    return found


def _longest(mass: np.ndarray, elastic: np.ndarray, viscous: np.ndarray) -> np.ndarray:
    """Return the steps dt of dt^2 k / 4 + dt c = m where k and c are not 0."""
    moves = elastic > 0
    m, k, c = mass[moves], elastic[moves], viscous[moves]
    return 2 * m / (c + np.sqrt(c**2 + k * m))
