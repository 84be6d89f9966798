"""Waves in the square lattice of rigid blocks; `test_rigid_motion` holds blocks to them."""

import numpy as np
import pytest

from closed_forms.block_lattice import Lattice, dynamic_matrix, modes

A, DENSITY, K_N, K_S = 0.5, 2400.0, 3e10, 1e10
MASS = DENSITY * A**2


def lattice():
    """Return blocks of 0.5 m whose faces are two Gauss points."""
    return Lattice(A, MASS, MASS * A**2 / 6, K_N * A, K_S * A, K_N * A**3 / 12)


def random_waves(count=200):
    """Return wave vectors over several Brillouin zones."""
    return np.random.default_rng(0).uniform(-3 * np.pi / A, 3 * np.pi / A, (count, 2))


def test_speeds_of_long_waves():
    """c_s^2 = k_s A^2 / 2 m and c_p^2 = k_n A^2 / m along x, off by (k A)^2; along the diagonal
    k_n A^2 / 2 m and (k_n + k_s) A^2 / 2 m, as C_12 = 0; blocks turn at 2 k_s A^2 / I."""
    one, x = lattice(), 1e-3
    k_n, k_s = one.normal_stiffness, one.shear_stiffness
    for direction in ([1.0, 0.0], [0.0, -1.0]):
        omega, _ = modes(one, x / A * np.array(direction))
        expected = A * np.sqrt(np.array([k_s / 2, k_n]) / MASS)
        assert omega[:2] * A / x == pytest.approx(expected, rel=1e-6)
        assert omega[2] == pytest.approx(np.sqrt(2 * k_s * A**2 / one.inertia), rel=1e-5)
    # Christoffel with C_11 = k_n, C_66 = k_s / 2, C_12 = 0: (k_n + k_s/2) / 2, and k_s / 4 off it.
    omega, _ = modes(one, x / A * np.array([1.0, 1.0]) / np.sqrt(2))
    expected = A * np.sqrt(np.array([k_n / 2, k_n / 2 + k_s / 2]) / MASS)
    assert omega[:2] * A / x == pytest.approx(np.sort(expected), rel=1e-6)


def test_rigid_motions_and_periodicity():
    """No stiffness against translation; a whole turn of the phase changes nothing."""
    one = lattice()
    np.testing.assert_array_equal(dynamic_matrix(one, [0.0, 0.0])[:2], 0)
    k = random_waves(20)
    turned = dynamic_matrix(one, k + 2 * np.pi / A * np.array([1, -2]))
    assert np.abs(turned - dynamic_matrix(one, k)).max() < 1e-13 * np.abs(turned).max()


def test_modes_have_unit_mass():
    one = lattice()
    omega, shapes = modes(one, random_waves(5))
    masses = np.diag([one.mass, one.mass, one.inertia])
    unit = np.swapaxes(shapes.conj(), -2, -1) @ masses @ shapes
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(3), unit.shape), atol=1e-13)
    assert omega.shape == (5, 3) and (np.diff(omega) >= 0).all()
