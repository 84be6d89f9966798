"""Leapfrog on chains and on planes of the row in space, in closed form."""

import numpy as np

from closed_forms.modes import Modes, modes, of_modes
from jointwave.compare.exact.blocks.plane import Plane


def frequencies(stiffness: float, mass: float, block_count: int) -> np.ndarray:
    """Return the chain's N natural frequencies (rad/s), undamped, free ends; the first is rigid.

    stiffness in N/m, mass in kg; or of torsion in N m and kg m2.
    """
    n = np.arange(block_count)
    return 2 * np.sqrt(stiffness / mass) * np.sin(n * np.pi / (2 * block_count))


def displacements(
    force: np.ndarray, steps: np.ndarray, dt: float, stiffness: float, mass: float, block_count: int
) -> np.ndarray:
    """Return the displacement (m) of a uniform free-free chain [block_count, len(steps)].

    Parameters
    ----------
    force : float array [n], force (N) on block 1 at steps 0, 1, ...; n at least max(steps).
    steps : int array of step numbers.
    dt : step, s, below the critical one, 2 / omega_max, where the highest mode would be double.
    stiffness, mass : of every joint (N/m) and block (kg).
    """
    centres = np.arange(block_count) + 0.5
    shapes = np.cos(np.outer(centres, np.arange(block_count)) * np.pi / block_count)
    shapes /= np.sqrt(mass * (shapes**2).sum(axis=0))
    chain = Modes(frequencies(stiffness, mass, block_count), shapes)
    return of_modes(chain, np.eye(block_count)[0], force, steps, dt)


def plane_modes(plane: Plane) -> Modes:
    """Return the modes of a plane of the spatial row, undamped, whose ends are free or
    fixed."""
    stiffness = plane.stiffness.diagonal()
    relative = plane.relative[:, plane.blocks].toarray()
    return modes(plane.mass, np.sqrt(stiffness)[:, None] * relative)
