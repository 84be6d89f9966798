"""Waves in periodic rigid blocks: closed forms, contacts that are assembled, a patch that is
marched."""

import numpy as np
import pytest

from closed_forms.bloch import brickwork, leapfrog, periodic, stiffness
from closed_forms.bloch import modes as bloch_modes
from closed_forms.block_lattice import Lattice, dynamic_matrix, modes
from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.compare.exact.blocks.system import carried, resistance

A, DENSITY, K_N, K_S = 0.5, 2400.0, 3e10, 1e10
MASS = DENSITY * A**2


def lattice(bending=1 / 12):
    """Return blocks of 0.5 m whose k_b is so much of k_n A^2."""
    k_n = K_N * A
    return Lattice(A, MASS, MASS * A**2 / 6, k_n, K_S * A, bending * k_n * A**2)


def random_waves(count=200):
    """Return wave vectors over several Brillouin zones."""
    return np.random.default_rng(0).uniform(-3 * np.pi / A, 3 * np.pi / A, (count, 2))


@pytest.mark.parametrize("share", [0.0, 0.75, 1.0])
def test_assembled_contacts_are_the_closed_form(share):
    """k_b = k_n A^2 / 12 of the whole face, of which two midpoints have three quarters."""
    cell = brickwork([A, A], 0.0, DENSITY, (K_N, K_S), (K_N, K_S), share)
    k = random_waves()
    expected = dynamic_matrix(lattice(share / 12), k)
    assert np.abs(stiffness(cell, k) - expected).max() < 1e-14 * np.abs(expected).max()


@pytest.mark.parametrize("dim", [2, 3])
def test_waves_that_fit_a_periodic_domain_are_those_of_one_block(dim):
    """The frequencies of a domain of several blocks, all in phase with their images, are those of
    one block at every wave vector that fits it."""
    counts, law = np.array([3, 2, 2])[:dim], {"normal_stiffness": K_N, "shear_stiffness": K_S}
    attitudes = [(0.0, 0.0), (90.0, 90.0), (90.0, 0.0)][:dim]
    sets = [
        JointSet.model_validate(
            {"name": str(k), "dip": dip, "spacing": A}
            | law
            | ({"dip_direction": way} if dim == 3 else {}),
            context={"dimension": dim},
        )
        for k, (dip, way) in enumerate(attitudes)
    ]
    blocks = blocks_of_domain(Domain(size=(A * counts).tolist()), sets)
    springs, names = np.array([[K_N, K_S]] * (dim + 1)), [one.name for one in sets]
    domain = periodic(blocks, DENSITY, springs, names, range(dim))
    cell = brickwork([A] * dim, 0.0, DENSITY, (K_N, K_S), (K_N, K_S))
    fits = np.stack(np.meshgrid(*map(np.arange, counts)), axis=-1).reshape(-1, dim)
    expected = np.sort(bloch_modes(cell, 2 * np.pi * fits / (A * counts))[0], axis=None)
    found = bloch_modes(domain, np.zeros(dim))[0]
    assert len(found) == len(expected)
    assert np.abs(found**2 - expected**2).max() < 1e-12 * expected.max() ** 2


def test_waves_along_an_axis_of_cubes():
    """All six branches: m omega^2 = 2 k_n (1 - cos X); I omega^2 = 2 k_t (1 - cos X) + 2 k_s A^2;
    and twice D_uu = 2 k_s (1 - cos X), |D_uphi| = k_s A sin X,
    D_phiphi = k_s A^2 (3 + cos X) / 2 + 2 k_b (1 - cos X). Turned axes exchange their freedoms."""
    cell = brickwork([A] * 3, 0.0, DENSITY, (K_N, K_S), (K_N, K_S))
    k_n, k_s, m, inertia = K_N * A**2, K_S * A**2, DENSITY * A**3, DENSITY * A**5 / 6
    k_b, k_t = k_n * A**2 / 12, k_s * A**2 / 6
    for X in np.random.default_rng(3).uniform(-np.pi, np.pi, 20):
        c = 1 - np.cos(X)
        off = k_s * A * np.sin(X) / np.sqrt(m * inertia)
        turns = (k_s * A**2 * (3 + np.cos(X)) / 2 + 2 * k_b * c) / inertia
        pair = np.linalg.eigvalsh([[2 * k_s * c / m, off], [off, turns]])
        single = [2 * k_n * c / m, (2 * k_t * c + 2 * k_s * A**2) / inertia]
        expected = np.sort([*single, *pair, *pair])
        for axis in np.eye(3):
            found = bloch_modes(cell, X / A * axis)[0] ** 2
            assert np.abs(found - expected).max() < 1e-12 * expected.max()


def test_oblique_waves_in_the_plane_of_cubes_are_those_of_squares():
    """Faces across the plane strain nothing where all layers move alike."""
    cell = brickwork([A] * 3, 0.0, DENSITY, (K_N, K_S), (K_N, K_S))
    k = np.random.default_rng(4).uniform(-np.pi / A, np.pi / A, (20, 2))
    found = stiffness(cell, np.insert(k, 2, 0.0, axis=1))[:, [[0], [1], [5]], [0, 1, 5]]
    expected = dynamic_matrix(lattice(), k) * A
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


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


@pytest.mark.parametrize("size", [[0.8, 0.3], [0.8, 0.4, 0.3]])
def test_the_choice_of_cell_does_not_matter(size):
    """Running bond with one brick a cell and, upright, with two: the branches of the larger cell
    are those of the smaller one at both of its wave vectors."""
    one, two = (brickwork(size, 0.5, DENSITY, (K_N, K_S), (2e10, 7e9), courses=n) for n in (1, 2))
    turned = np.eye(len(size))[-1] * 2 * np.pi / 0.6
    for k in np.random.default_rng(1).uniform(-4, 4, (10, len(size))):
        both = [bloch_modes(one, k + m * turned)[0] for m in (0, 1)]
        np.testing.assert_allclose(bloch_modes(two, k)[0], np.sort(np.concatenate(both)), rtol=1e-7)


def march(cell, vectors, q, v, step, steps):
    """Return q [..., *cells, freedoms] after so many steps of leapfrog in a periodic patch of cells
    of one block each, contact by contact; v is the velocity half a step before."""
    dim, freedoms = len(vectors), cell.mass.shape[1]
    axes = tuple(range(-dim - 1, -1))
    i, j = (carried(cell.contacts.arm[:, side], freedoms) for side in (0, 1))
    D = resistance(cell.contacts, cell.contacts.springs, freedoms).toarray()
    cells = np.rint(cell.shift @ np.linalg.inv(vectors)).astype(int)
    for _ in range(steps):
        force = np.zeros_like(q)
        for c, shift in enumerate(cells):
            own = slice(c * freedoms, (c + 1) * freedoms)
            other = np.roll(q, tuple(-shift), axis=axes)
            pull = (other @ j[c].T - q @ i[c].T) @ D[own, own]
            force += pull @ i[c] - np.roll(pull @ j[c], tuple(shift), axis=axes)
        v = v + step * force / cell.mass[0]
        q = q + step * v
    return q


@pytest.mark.parametrize(
    ("size", "offset", "counts"),
    [
        ([0.8, 0.5], 0.0, (8, 6)),
        ([0.8, 0.5], 0.5, (8, 6)),
        ([0.8, 0.5], 0.3, (8, 6)),
        ([0.8, 0.4, 0.5], 0.5, (4, 3, 4)),
    ],
)
def test_a_patch_that_is_marched(size, offset, counts):
    """Leapfrog in periodic cells, 400 steps at 0.9 of the critical step, against each mode of three
    wave vectors at the discrete frequency: round-off, also in running bond."""
    cell, dim = brickwork(size, offset, DENSITY, (K_N, K_S), (2e10, 7e9)), len(size)
    vectors = np.diag(size)
    vectors[-1, 0] = offset * size[0]
    reciprocal = 2 * np.pi * np.linalg.inv(vectors).T
    highest = bloch_modes(cell, np.random.default_rng(2).uniform(-9, 9, (500, dim)))[0].max()
    step, steps = 0.9 * 2 / highest, 400
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1) @ vectors
    waves = np.array([(1, 2, 1), (3, -1, 0), (0, 3, 2)])[:, :dim] / counts @ reciprocal
    modes = [(k, *mode) for k in waves for mode in zip(*_branches(cell, k), strict=True)]

    def motion(n):
        turns = [np.exp(1j * (cells @ k - leapfrog(w, step) * n * step)) for k, w, _ in modes]
        return np.array(
            [(t[..., None] * s).real for t, (_, _, s) in zip(turns, modes, strict=True)]
        )

    before = (motion(0) - motion(-1)) / step
    found = march(cell, vectors, motion(0), before, step, steps)
    off = np.abs(found - motion(steps)).reshape(len(modes), -1).max(axis=1)
    assert len(off) == 3 * cell.mass.shape[1]
    assert (off < [1e-11 * np.abs(shape).max() for _, _, shape in modes]).all()


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
