"""Waves in any periodic arrangement of rigid blocks, in the plane and in space.

A contact of block i with the image of block j that the lattice vector L takes there has the energy
r D r / 2 of the relative motion r at its centre (`compare.exact.blocks.system`). In a wave
q e^{i (k . L - omega t)} of the images,

    r = B(k) q,   K(k) = B^H D B,   K(k) q = omega^2 M q

(Floquet-Bloch; Brillouin, Wave Propagation in Periodic Structures, 1946). The phase of a block is
that of its cell. Holds for small motions of contacts that stay closed and do not slip. Leapfrog on
it is exact too (`leapfrog`)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.periodic import contacts_across
from jointwave.compare.exact.blocks.system import Contacts, contacts_of, relative, resistance


class Cell(NamedTuple):
    """The blocks and contacts of a cell.

    mass : [blocks, freedoms], kg and kg m2 (in the plane per m). contacts : of blocks i with images
    of blocks j. shift : of the images [contacts, d], m."""

    mass: np.ndarray
    contacts: Contacts
    shift: np.ndarray


def stiffness(cell: Cell, wave_vectors: np.ndarray) -> np.ndarray:
    """Return K(k), Hermitian complex array [..., n, n], of wave vectors [..., d], rad/m."""
    count, freedoms = cell.mass.shape
    ends = []
    for side in (1, 0):
        blocks = cell.contacts.blocks.copy()
        blocks[:, side] = OUTSIDE
        ends.append(relative(cell.contacts._replace(blocks=blocks), count, freedoms).toarray())
    phase = np.exp(1j * np.asarray(wave_vectors, dtype=float) @ cell.shift.T)
    B = ends[0] + np.repeat(phase, freedoms, axis=-1)[..., None] * ends[1]
    D = resistance(cell.contacts, cell.contacts.springs, freedoms).toarray()
    return np.swapaxes(B.conj(), -2, -1) @ (D @ B)


def modes(cell: Cell, wave_vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return omega [..., n] (rad/s), ascending, and the modes [..., n, mode], of unit modal mass:
    columns q of the freedoms of each block, m and rad."""
    return natural(stiffness(cell, wave_vectors), cell.mass.ravel())


def natural(K: np.ndarray, masses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return omega (rad/s) and modes of unit modal mass of Hermitian K against diag(masses)."""
    root = np.sqrt(masses)
    squares, shapes = np.linalg.eigh(K / (root[:, None] * root))
    return np.sqrt(np.maximum(squares, 0.0)), shapes / root[:, None]


def leapfrog(omega: np.ndarray, step: float) -> np.ndarray:
    """Return the frequency Omega (rad/s) at which leapfrog of this step (s) runs a mode, exactly:
    sin(Omega dt / 2) = omega dt / 2."""
    return 2 / step * np.arcsin(np.asarray(omega) * step / 2)


def periodic(
    blocks: Blocks,
    density: float,
    springs: np.ndarray,
    sets: Sequence[str],
    axes: Sequence[int],
    bending: float = 1.0,
) -> Cell:
    """Return a domain with periodic sides across these axes as a cell.

    springs : normal and shear stiffness of each joint set and, last, of cuts through rock, Pa/m.
    sets : their names. bending : part of the second moments that the points of contacts have."""
    extent = np.ptp(blocks.body.vertices, axis=0)
    parts = [(blocks.contacts, 0 * extent)]
    for axis in axes:
        facets = contacts_across(blocks, axis, ("high", "low"), sets)
        parts.append((facets, extent * np.eye(len(extent))[axis]))
    contacts = [_contacts(blocks, facets, springs, bending, shift) for facets, shift in parts]
    shifts = [np.tile(shift, (len(facets), 1)) for facets, shift in parts]
    whole = Contacts(*map(np.concatenate, zip(*contacts, strict=True)))
    return Cell(masses(blocks, density), whole, np.concatenate(shifts))


def masses(blocks: Blocks, density: float) -> np.ndarray:
    """Return the masses and moments of inertia of blocks [n, freedoms] whose principal axes are
    those of the coordinates."""
    mass, second = density * blocks.volume, density * blocks.second_moment
    dim, around = second.shape[1], np.trace(second, axis1=1, axis2=2)[:, None]
    if dim == 3:
        around = around - np.diagonal(second, axis1=1, axis2=2)
    return np.concatenate([np.tile(mass, (dim, 1)).T, around], axis=1)


def _contacts(
    blocks: Blocks, facets: Facets, springs: np.ndarray, bending: float, shift: np.ndarray | float
) -> Contacts:
    own = np.asarray(springs, dtype=float)[facets.joint_set]
    return contacts_of(blocks, facets, own, 0 * own, bending, shift)
