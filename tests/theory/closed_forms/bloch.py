"""Waves in any periodic arrangement of rigid blocks with point contacts in the plane.

A block has the freedoms (u, v, phi), phi anticlockwise, and moves at the place r by
(u, v) + phi (-y, x), (x, y) = r - centroid. A contact of normal n, tangent t = n turned
anticlockwise, between block i and the image of block j that lies the lattice vector L away has the
energy (k_n d_n^2 + k_s d_t^2) / 2 of the relative displacement d there. In a wave
q e^{i (k . L - omega t)} of the images,

    d = B(k) q,   K(k) = sum over contacts of B^H diag(k_n, k_s) B,   K(k) q = omega^2 M q

(Floquet-Bloch; Brillouin, Wave Propagation in Periodic Structures, 1946). The phase of a block is
that of its cell. Holds for small motions of contacts that stay closed and do not slip.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss


@dataclass(frozen=True)
class Cell:
    """One cell of B blocks and C contacts.

    Attributes
    ----------
    vectors : of the lattice, rows [2, 2], m.
    centroid, mass, inertia : of the blocks: [B, 2], [B], [B]; m, kg, kg m2 (each per m thickness in
        plane strain, as are the stiffnesses).
    point, normal : of the contacts, beside the first block, [C, 2]; m, unit vectors.
    pair : first and second block, integers [C, 2].
    shift : cells from the first to the second, integers [C, 2].
    normal_stiffness, shear_stiffness : [C], N/m.
    """

    vectors: np.ndarray
    centroid: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    pair: np.ndarray
    shift: np.ndarray
    normal_stiffness: np.ndarray
    shear_stiffness: np.ndarray


def stiffness(cell: Cell, wave_vectors: np.ndarray) -> np.ndarray:
    """Return K(k), Hermitian complex array [..., 3 B, 3 B] in N/m, N and N m.

    wave_vectors : k, [..., 2], rad/m.
    """
    k = np.asarray(wave_vectors, dtype=float)
    lattice = np.asarray(cell.shift) @ cell.vectors
    blocks = 3 * len(cell.mass)
    K = np.zeros((*k.shape[:-1], blocks, blocks), dtype=complex)
    for c, (i, j) in enumerate(cell.pair):
        rows = np.array([cell.normal[c], (-cell.normal[c][1], cell.normal[c][0])])
        B = np.zeros((*k.shape[:-1], 2, blocks), dtype=complex)
        B[..., 3 * i : 3 * i + 3] -= rows @ _motion(cell.point[c] - cell.centroid[i])
        phase = np.exp(1j * k @ lattice[c])[..., None, None]
        B[..., 3 * j : 3 * j + 3] += (
            rows @ _motion(cell.point[c] - lattice[c] - cell.centroid[j]) * phase
        )
        weights = np.array([[cell.normal_stiffness[c]], [cell.shear_stiffness[c]]])
        K += np.swapaxes(B.conj(), -2, -1) @ (weights * B)
    return K


def modes(cell: Cell, wave_vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return omega [..., 3 B] (rad/s), ascending, and the modes [..., 3 B, mode], of unit modal
    mass: columns q of (u, v, phi) of each block, m and rad."""
    masses = np.stack([cell.mass, cell.mass, cell.inertia], axis=-1).ravel()
    return natural(stiffness(cell, wave_vectors), masses)


def natural(K: np.ndarray, masses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return omega (rad/s) and modes of unit modal mass of Hermitian K against diag(masses)."""
    root = np.sqrt(masses)
    squares, shapes = np.linalg.eigh(K / (root[:, None] * root))
    return np.sqrt(np.maximum(squares, 0.0)), shapes / root[:, None]


def leapfrog(omega: np.ndarray, step: float) -> np.ndarray:
    """Return the frequency Omega (rad/s) at which leapfrog of this step (s) runs a mode, exactly:
    sin(Omega dt / 2) = omega dt / 2."""
    return 2 / step * np.arcsin(np.asarray(omega) * step / 2)


def brickwork(
    length: float,
    height: float,
    offset: float,
    density: float,
    head: tuple[float, float],
    bed: tuple[float, float],
    points: int = 2,
) -> Cell:
    """Return courses of equal bricks, each shifted against the one below; one brick is a cell.

    Parameters
    ----------
    length, height : of a brick along x and y, m.
    offset : of a course against that below it over `length`, 0 (a stack) to 1; 0.5 is running bond.
    density : kg/m3; the thickness is 1 m.
    head, bed : normal and shear stiffness of the upright and the lying joints, Pa/m.
    points : Gauss points of each contact; 2 have the whole bending stiffness of the joint.
    """
    mass = density * length * height
    rows = list(_joint((1, 0), (1.0, 0.0), (length / 2, -height / 2), height, head, points))
    beds = (((0, 1), offset - 0.5, 1 - offset), ((-1, 1), -0.5, offset))
    for shift, start, share in beds:
        if share > 0:
            corner = (start * length, height / 2)
            rows += _joint(shift, (0.0, 1.0), corner, share * length, bed, points)
    shifts, normals, places, normal, shear = (np.array(x) for x in zip(*rows, strict=True))
    return Cell(
        vectors=np.array([[length, 0.0], [offset * length, height]]),
        centroid=np.zeros((1, 2)),
        mass=np.array([mass]),
        inertia=np.array([mass * (length**2 + height**2) / 12]),
        point=places,
        normal=normals,
        pair=np.zeros((len(rows), 2), dtype=int),
        shift=shifts,
        normal_stiffness=normal,
        shear_stiffness=shear,
    )


def _joint(shift, normal, corner, size, stiffnesses, points) -> Iterator[tuple]:
    """Yield shift, normal, point and both stiffnesses (N/m) of each contact of a joint."""
    along = np.array([normal[1], normal[0]])
    for x, weight in zip(*leggauss(points), strict=True):
        share = weight / 2 * size
        yield shift, normal, corner + (x + 1) / 2 * size * along, *(share * k for k in stiffnesses)


def _motion(r: np.ndarray) -> np.ndarray:
    """Return what (u, v, phi) of a block do at r (m) from its centroid, [2, 3]."""
    return np.array([[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]])
