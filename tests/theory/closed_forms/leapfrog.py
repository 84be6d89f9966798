"""Leapfrog on chains and on blocks in any dimension, in closed form."""

import numpy as np

from closed_forms.modes import Modes, modes, of_modes
from jointwave.compare.exact.blocks.system import Contacts, relative, resistance


def frequencies(stiffness: float, mass: float, block_count: int) -> np.ndarray:
    """Return the chain's N natural frequencies (rad/s), undamped, free ends; the first is rigid.
    stiffness in N/m, mass in kg; or of torsion in N m and kg m2."""
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


def modes_of_blocks(mass: np.ndarray, contacts: Contacts) -> Modes:
    """Return the modes of blocks, undamped, whose contacts' stiffness is diagonal; all bodies
    without a finite mass are at rest."""
    own = np.flatnonzero(np.isfinite(mass))
    stiffness = resistance(contacts, contacts.springs, mass.shape[1]).diagonal()
    moved = relative(contacts, *mass.shape)[:, own].toarray()
    return modes(mass.ravel()[own], np.sqrt(stiffness)[:, None] * moved)
