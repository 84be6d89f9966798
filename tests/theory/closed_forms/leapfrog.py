"""Leapfrog on chains and on blocks in any dimension, in closed form."""

import numpy as np

from closed_forms.modes import Modes, modes
from jointwave.compare.exact.blocks.system import Contacts, relative, resistance


def frequencies(stiffness: float, mass: float, block_count: int) -> np.ndarray:
    """Return the chain's N natural frequencies (rad/s), undamped, free ends; the first is rigid.
    stiffness in N/m, mass in kg; or of torsion in N m and kg m2."""
    n = np.arange(block_count)
    return 2 * np.sqrt(stiffness / mass) * np.sin(n * np.pi / (2 * block_count))


def modes_of_blocks(mass: np.ndarray, contacts: Contacts) -> Modes:
    """Return the modes of blocks, undamped, whose contacts' stiffness is diagonal; all bodies
    without a finite mass are at rest."""
    own = np.flatnonzero(np.isfinite(mass))
    stiffness = resistance(contacts, contacts.springs, mass.shape[1]).diagonal()
    moved = relative(contacts, *mass.shape)[:, own].toarray()
    return modes(mass.ravel()[own], np.sqrt(stiffness)[:, None] * moved)
