"""A plane of the spatial row as x' = A x + b f(t) + g, and the forces in its contacts.

With the coordinates X (the blocks' u, the faces' w), the contacts' relative motions r = B X,
stiffness D and viscosity C of the contacts, and alpha of mass-proportional damping

    M u'' + alpha M u' + [B^T (D r + C r')]_u = load + M gravity
    Z w' + [B^T (D r + C r')]_w = 0            on a matched end's massless face

while a held face is at rest, or moves with the base. The contact j exerts -(D r + C r') on its
right side. States are mass-weighted, and displacements are scaled by w, so that the entries of A
are of similar magnitude.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from compare.exact.blocks.spatial import Plane


class SpatialSystem(NamedTuple):
    """The first-order form of one plane, n = N c degrees of freedom of the blocks in m states.

    matrix, load, gravity : A [m, m] (1/s), b [m] of a unit drive, g [m].
    displacement, velocity : float arrays [n, m], from the state to the blocks' motion; m, m/s (rad,
        rad/s). forces, direct : [(N + 1) c, m] and [(N + 1) c], forces (N, N m) of the contacts and
        of the drive at the start on their right side, per state and per unit drive.
    """

    matrix: np.ndarray
    load: np.ndarray
    gravity: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    forces: np.ndarray
    direct: np.ndarray


def system(
    plane: Plane, push: np.ndarray, gravity: np.ndarray, base: np.ndarray | None = None
) -> SpatialSystem:
    """Return the first-order form of a plane.

    Parameters
    ----------
    push : float array [c], forces and moments at the centre of the start's face per unit drive.
    gravity : float array [c], acceleration of every block, m/s2.
    base : float array [c], velocity of the start's held face per unit drive; None: at rest.
    """
    n, c, q, f = len(plane.mass), len(push), plane.blocks, plane.faces
    B, D, C = plane.relative, plane.stiffness, plane.viscosity
    X, V, driven = _coordinates(plane, base)
    resist = B.T @ (D @ B @ X + C @ B @ V)
    if len(f):
        faces = B[:, f].T @ C @ B[:, f] + np.kron(np.eye(len(f) // c), plane.dashpot)
        V[f] = -np.linalg.solve(faces, resist[f])
        resist += B.T @ C @ B[:, f] @ V[f]
    A = np.concatenate([V[q], -resist[q] / plane.mass[:, None] - plane.mass_damping * V[q], V[f]])
    load = np.concatenate([0 * driven[q], B[:c, q].T @ push - (B.T @ C @ B @ driven)[q]])
    load[n:] /= plane.mass
    weight = np.concatenate([np.zeros(n), np.tile(gravity, n // c)])
    direct = -C @ B @ driven
    direct[:c] += push
    forces, size = -(D @ B @ X + C @ B @ V), X.shape[1]
    matrix, b, g = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    matrix[: len(A)], b[: 2 * n], g[: 2 * n] = A, load, weight
    if base is not None:
        b[-1] = 1
    return _scaled(plane, SpatialSystem(matrix, b, g, X[q], V[q], forces, direct))


def _coordinates(plane: Plane, base: np.ndarray | None) -> tuple[np.ndarray, ...]:
    """Return the matrices [(N + 2) c, m] from the state to the coordinates and to their rates, and
    the rates [(N + 2) c] per unit drive. A state holds displacements and velocities of the blocks,
    displacements of the matched faces and of a moving base. Balance gives the faces' rates.
    """
    n, q, f = len(plane.mass), plane.blocks, plane.faces
    count, size = plane.relative.shape[1], 2 * n + len(f) + (base is not None)
    position, velocity, driven = np.zeros((count, size)), np.zeros((count, size)), np.zeros(count)
    position[q, np.arange(n)] = velocity[q, n + np.arange(n)] = 1
    position[f, 2 * n + np.arange(len(f))] = 1
    if base is not None:
        position[: len(base), -1] = driven[: len(base)] = base
    return position, velocity, driven


def at_rest(system: SpatialSystem) -> np.ndarray:
    """Return the state [m] in which the blocks rest under gravity; an end must be fixed.

    The base, if there is one, is at zero: its row of the matrix has no entries.
    """
    moves = system.matrix.any(axis=1)
    state = np.zeros(len(moves))
    own = np.ix_(moves, moves)
    state[moves] = np.linalg.solve(system.matrix[own], -system.gravity[moves])
    return state


def _scaled(plane: Plane, s: SpatialSystem) -> SpatialSystem:
    n, c = len(plane.mass), len(plane.freedoms)
    held = len(s.load) - 2 * n
    roots = np.sqrt(plane.mass)
    rate = 2 * sqrt(np.abs(s.matrix[n : 2 * n, :n]).max()) or 1.0
    scale = np.concatenate([rate * roots, roots, rate * np.resize(roots[:c], held)])
    return SpatialSystem(
        matrix=s.matrix * scale[:, None] / scale,
        load=s.load * scale,
        gravity=s.gravity * scale,
        displacement=s.displacement / scale,
        velocity=s.velocity / scale,
        forces=s.forces / scale,
        direct=s.direct,
    )
