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
COUNTS = np.array([3, 2])  # of squares along each axis


def squares(bending):
    """Return squares of 0.5 m between periodic sides."""
    law = {"normal_stiffness": K_N, "shear_stiffness": K_S, "spacing": A}
    tables = [law | {"name": name, "dip": dip} for name, dip in (("bed", 0.0), ("head", 90.0))]
    sets = [JointSet.model_validate(table, context={"dimension": 2}) for table in tables]
    blocks = blocks_of_domain(Domain(size=(A * COUNTS).tolist()), sets)
    return periodic(blocks, DENSITY, np.array([[K_N, K_S]] * 3), ["bed", "head"], [0, 1], bending)


def square(bending):
    """k_b = k_n A^2 / 12 of the whole face, of which two midpoints have three quarters."""
    mass, k_n = DENSITY * A**2, K_N * A
    return Lattice(A, mass, mass * A**2 / 6, k_n, K_S * A, bending / 12 * k_n * A**2)


@pytest.mark.parametrize("share", [0.0, 0.75, 1.0])
def test_waves_in_squares_are_the_closed_form(share):
    """Six blocks in a wave k have the frequencies of one at k and all waves that fit them."""
    fitting = 2 * np.pi * np.array(list(np.ndindex(*COUNTS))) / (A * COUNTS)
    for k in np.random.default_rng(0).uniform(-3 * np.pi / A, 3 * np.pi / A, (10, 2)):
        found = modes(squares(share), k)[0]
        expected = np.sort(square_modes(square(share), k + fitting)[0], axis=None)
        assert np.abs(found**2 - expected**2).max() < 1e-12 * expected.max() ** 2
