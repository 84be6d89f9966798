"""Waves in periodic rigid blocks: closed form, assembled form, and a patch that is marched."""

from dataclasses import replace

import numpy as np
import pytest

from closed_forms.bloch import Cell, brickwork, leapfrog, stiffness
from closed_forms.bloch import modes as bloch_modes
from closed_forms.block_lattice import Lattice, dynamic_matrix, modes

A, DENSITY, K_N, K_S = 0.5, 2400.0, 3e10, 1e10
MASS = DENSITY * A**2


def lattice(bending=1 / 12):
    """Return blocks of 0.5 m whose k_b is so much of k_n A^2."""
    k_n = K_N * A
    return Lattice(A, MASS, MASS * A**2 / 6, k_n, K_S * A, bending * k_n * A**2)


def random_waves(count=200):
    """Return wave vectors over several Brillouin zones."""
    return np.random.default_rng(0).uniform(-3 * np.pi / A, 3 * np.pi / A, (count, 2))


@pytest.mark.parametrize("points, bending", [(1, 0.0), (2, 1 / 12), (3, 1 / 12)])
def test_assembled_contacts_are_the_closed_form(points, bending):
    """Gauss points on the faces: k_b = k_n A^2 / 12 from two on, nothing with one."""
    cell = brickwork(A, A, 0.0, DENSITY, (K_N, K_S), (K_N, K_S), points)
    k = random_waves()
    expected = dynamic_matrix(lattice(bending), k)
    assert np.abs(stiffness(cell, k) - expected).max() < 1e-14 * np.abs(expected).max()


def test_midpoint_contacts_bend_less():
    """Two points at a quarter of the side, half of k_n each: k_b = k_n A^2 / 16."""
    cell = brickwork(A, A, 0.0, DENSITY, (K_N, K_S), (K_N, K_S))
    place = np.where(np.abs(cell.point) < A / 2 - 1e-9, np.sign(cell.point) * A / 4, cell.point)
    k = random_waves()
    expected = dynamic_matrix(lattice(1 / 16), k)
    found = stiffness(replace(cell, point=place), k)
    assert np.abs(found - expected).max() < 1e-14 * np.abs(expected).max()


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


def test_the_choice_of_cell_does_not_matter():
    """Running bond with one brick a cell and, upright, with two: the branches of the larger cell
    are those of the smaller one at both of its wave vectors."""
    one = brickwork(0.8, 0.3, 0.5, DENSITY, (K_N, K_S), (2e10, 7e9))
    count = len(one.shear_stiffness)
    tall = np.array([[0.8, 0.0], [0.0, 0.6]])
    pair, shift, point = [], [], []
    for course in (0, 1):
        for c in range(count):
            across, up = one.shift[c]
            # A course up is half a brick along: from the odd course the next cell begins.
            other = (course + up) % 2
            along = across + (1 if up and course else 0)
            pair.append((course, other))
            shift.append((along, (course + up) // 2))
            point.append(one.point[c] + course * np.array([0.4, 0.3]))
    two = Cell(
        tall,
        np.array([[0.0, 0.0], [0.4, 0.3]]),
        *(np.repeat(x, 2) for x in (one.mass, one.inertia)),
        np.array(point),
        np.tile(one.normal, (2, 1)),
        np.array(pair),
        np.array(shift),
        *(np.tile(x, 2) for x in (one.normal_stiffness, one.shear_stiffness)),
    )
    for k in np.random.default_rng(1).uniform(-4, 4, (10, 2)):
        both = [bloch_modes(one, k + m * np.array([0, 2 * np.pi / 0.6]))[0] for m in (0, 1)]
        found = bloch_modes(two, k)[0]
        np.testing.assert_allclose(found, np.sort(np.concatenate(both)), rtol=1e-7)


def march(cell, q, v, step, steps):
    """Return q [..., n_x, n_y, 3] after so many steps of leapfrog in a periodic patch of cells of
    one block each, contact by contact; v is the velocity half a step before."""
    masses = np.array([cell.mass[0], cell.mass[0], cell.inertia[0]])
    for _ in range(steps):
        force = np.zeros_like(q)
        for c in range(len(cell.point)):
            normal = cell.normal[c]
            tangent = np.array([-normal[1], normal[0]])
            other = np.roll(q, tuple(-cell.shift[c]), axis=(-3, -2))
            near = cell.point[c] - cell.centroid[0]
            far = near - cell.shift[c] @ cell.vectors
            jump = other[..., :2] + other[..., 2:] * np.array([-far[1], far[0]])
            jump = jump - q[..., :2] - q[..., 2:] * np.array([-near[1], near[0]])
            pull = cell.normal_stiffness[c] * (jump @ normal)[..., None] * normal
            pull = pull + cell.shear_stiffness[c] * (jump @ tangent)[..., None] * tangent
            force[..., :2] += pull
            force[..., 2] += near[0] * pull[..., 1] - near[1] * pull[..., 0]
            back = np.roll(pull, tuple(cell.shift[c]), axis=(-3, -2))
            force[..., :2] -= back
            force[..., 2] -= far[0] * back[..., 1] - far[1] * back[..., 0]
        v = v + step * force / masses
        q = q + step * v
    return q


@pytest.mark.parametrize("offset", [0.0, 0.5, 0.3])
def test_a_patch_that_is_marched(offset):
    """Leapfrog in 8 x 6 periodic cells, 400 steps at 0.9 of the critical step, against each mode of
    three wave vectors at the discrete frequency: round-off, also in running bond."""
    cell, counts = brickwork(0.8, 0.5, offset, DENSITY, (K_N, K_S), (2e10, 7e9)), (8, 6)
    reciprocal = 2 * np.pi * np.linalg.inv(cell.vectors).T
    highest = bloch_modes(cell, np.random.default_rng(2).uniform(-9, 9, (500, 2)))[0].max()
    step, steps = 0.9 * 2 / highest, 400
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1) @ cell.vectors
    vectors = [np.array(waves) / counts @ reciprocal for waves in ((1, 2), (3, -1), (0, 3))]
    modes = [(k, *mode) for k in vectors for mode in zip(*_branches(cell, k), strict=True)]

    def waves(n):
        turns = [np.exp(1j * (cells @ k - leapfrog(w, step) * n * step)) for k, w, _ in modes]
        return np.array(
            [(t[..., None] * s).real for t, (_, _, s) in zip(turns, modes, strict=True)]
        )

    before = (waves(0) - waves(-1)) / step
    off = np.abs(march(cell, waves(0), before, step, steps) - waves(steps)).max(axis=(1, 2, 3))
    assert len(off) == 9 and (off < [1e-11 * np.abs(shape).max() for _, _, shape in modes]).all()


def _branches(cell, k):
    """Return the frequencies of a wave vector, and their shapes one a row."""
    omega, shapes = bloch_modes(cell, k)
    return omega, shapes.T


def test_modes_have_unit_mass():
    one = lattice()
    omega, shapes = modes(one, random_waves(5))
    masses = np.diag([one.mass, one.mass, one.inertia])
    unit = np.swapaxes(shapes.conj(), -2, -1) @ masses @ shapes
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(3), unit.shape), atol=1e-13)
    assert omega.shape == (5, 3) and (np.diff(omega) >= 0).all()
