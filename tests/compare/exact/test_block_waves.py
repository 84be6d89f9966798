"""Waves in periodic rigid blocks whose contacts are assembled, against closed forms."""

import numpy as np
import pytest

from closed_forms.bloch import modes, periodic
from closed_forms.block_lattice import Lattice
from closed_forms.block_lattice import modes as square_modes
from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet

A, DENSITY, K_N, K_S = 0.5, 2400.0, 3e10, 1e10
ATTITUDES = [(0.0, 0.0), (90.0, 90.0), (90.0, 0.0)]


def cubes(counts, bending=1.0):
    """Return so many squares or cubes of 0.5 m along each axis between periodic sides."""
    dim, law = len(counts), {"normal_stiffness": K_N, "shear_stiffness": K_S, "spacing": A}
    tables = [
        law | {"name": str(k), "dip": dip} | ({"dip_direction": way} if dim == 3 else {})
        for k, (dip, way) in enumerate(ATTITUDES[:dim])
    ]
    sets = [JointSet.model_validate(table, context={"dimension": dim}) for table in tables]
    blocks = blocks_of_domain(Domain(size=(A * np.array(counts)).tolist()), sets)
    springs, names = np.array([[K_N, K_S]] * (dim + 1)), [one.name for one in sets]
    return periodic(blocks, DENSITY, springs, names, range(dim), bending)


def square(bending=1.0):
    """k_b = k_n A^2 / 12 of the whole face, of which two midpoints have three quarters."""
    mass, k_n = DENSITY * A**2, K_N * A
    return Lattice(A, mass, mass * A**2 / 6, k_n, K_S * A, bending / 12 * k_n * A**2)


def fitting(counts):
    """Return the wave vectors that fit a periodic domain, rad/m."""
    whole = np.stack(np.meshgrid(*map(np.arange, counts)), axis=-1).reshape(-1, len(counts))
    return 2 * np.pi * whole / (A * np.array(counts))


@pytest.mark.parametrize("share", [0.0, 0.75, 1.0])
def test_waves_in_squares_are_the_closed_form(share):
    """Six blocks in a wave k have the frequencies of one at k and all waves that fit them."""
    for k in np.random.default_rng(0).uniform(-3 * np.pi / A, 3 * np.pi / A, (10, 2)):
        found = modes(cubes([3, 2], share), k)[0]
        expected = np.sort(square_modes(square(share), k + fitting([3, 2]))[0], axis=None)
        assert np.abs(found**2 - expected**2).max() < 1e-12 * expected.max() ** 2


def among(found, expected):
    """Return whether all squares of frequencies are among those found, to round-off."""
    return np.abs(found - expected[:, None]).min(axis=1).max() < 1e-12 * found.max()


def test_waves_along_an_axis_of_cubes():
    """All six branches: m omega^2 = 2 k_n (1 - cos X); I omega^2 = 2 k_t (1 - cos X) + 2 k_s A^2;
    and twice D_uu = 2 k_s (1 - cos X), |D_uphi| = k_s A sin X,
    D_phiphi = k_s A^2 (3 + cos X) / 2 + 2 k_b (1 - cos X). Turned axes exchange their freedoms."""
    k_n, k_s, m, inertia = K_N * A**2, K_S * A**2, DENSITY * A**3, DENSITY * A**5 / 6
    k_b, k_t = k_n * A**2 / 12, k_s * A**2 / 6
    for X in np.random.default_rng(3).uniform(-np.pi, np.pi, 5):
        c = 1 - np.cos(X)
        off = k_s * A * np.sin(X) / np.sqrt(m * inertia)
        turns = (k_s * A**2 * (3 + np.cos(X)) / 2 + 2 * k_b * c) / inertia
        pair = np.linalg.eigvalsh([[2 * k_s * c / m, off], [off, turns]])
        single = [2 * k_n * c / m, (2 * k_t * c + 2 * k_s * A**2) / inertia]
        for axis in np.eye(3):
            found = modes(cubes([2, 2, 2]), X / A * axis)[0] ** 2
            assert len(found) == 48 and among(found, np.array([*single, *pair]))
