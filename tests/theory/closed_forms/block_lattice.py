"""Square lattice of rigid blocks of side A: waves of any length and direction in closed form.

Faces have the stiffnesses k_n, k_s (N/m) and the bending stiffness k_b (N m), the blocks mass m and
inertia I. With x = k_x A, y = k_y A, freedoms (u, v, phi) and a wave e^{i (k . r - omega t)}

    D_uu = 2 k_n (1 - cos x) + 2 k_s (1 - cos y)        D_uphi = -i k_s A sin y
    D_vv = 2 k_s (1 - cos x) + 2 k_n (1 - cos y)        D_vphi =  i k_s A sin x
    D_phiphi = (k_s A^2 / 2)(2 + cos x + cos y) + 2 k_b (2 - cos x - cos y)

and omega^2 are the eigenvalues of D against diag(m, m, I). Derived from the energy of the contacts:
`bloch` assembles it. A face of contact points at the distances h along it has
k_b = sum k_n h^2: k_n A^2 / 12 of two Gauss points or of the whole face, k_n A^2 / 16 of two points
at a quarter of the side.

Long waves along x have the speeds c_p^2 = k_n A^2 / m and c_s^2 = k_s A^2 / (2 m), since both sets
of joints shear; the third branch begins at omega^2 = 2 k_s A^2 / I, the blocks turning in place.
C_12 = 0: pressure along x does not press along y, whatever the stiffnesses. Leapfrog on it is exact
too (`bloch.leapfrog`)."""

from dataclasses import dataclass

import numpy as np

from closed_forms.bloch import natural


@dataclass(frozen=True)
class Lattice:
    """A square lattice: side A (m), mass (kg), inertia (kg m2), k_n, k_s (N/m), k_b (N m)."""

    side: float
    mass: float
    inertia: float
    normal_stiffness: float
    shear_stiffness: float
    bending_stiffness: float


def dynamic_matrix(lattice: Lattice, wave_vectors: np.ndarray) -> np.ndarray:
    """Return D, Hermitian complex array [..., 3, 3]; wave_vectors [..., 2], rad/m."""
    x, y = np.moveaxis(np.asarray(wave_vectors, dtype=float) * lattice.side, -1, 0)
    k_n, k_s, A = lattice.normal_stiffness, lattice.shear_stiffness, lattice.side
    D = np.zeros((*x.shape, 3, 3), dtype=complex)
    D[..., 0, 0] = 2 * k_n * (1 - np.cos(x)) + 2 * k_s * (1 - np.cos(y))
    D[..., 1, 1] = 2 * k_s * (1 - np.cos(x)) + 2 * k_n * (1 - np.cos(y))
    D[..., 2, 2] = k_s * A**2 / 2 * (2 + np.cos(x) + np.cos(y))
    D[..., 2, 2] += 2 * lattice.bending_stiffness * (2 - np.cos(x) - np.cos(y))
    D[..., 0, 2] = -1j * k_s * A * np.sin(y)
    D[..., 1, 2] = 1j * k_s * A * np.sin(x)
    D[..., 2, :2] = D[..., :2, 2].conj()
    return D


def modes(lattice: Lattice, wave_vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return omega [..., 3] (rad/s), ascending, and modes [..., 3, mode] of unit modal mass."""
    masses = np.array([lattice.mass, lattice.mass, lattice.inertia])
    return natural(dynamic_matrix(lattice, wave_vectors), masses)
