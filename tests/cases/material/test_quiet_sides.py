"""Dashpots of quiet sides against springs in a row, in the plane and in space."""

from pathlib import Path

import numpy as np
import pytest

from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.validate import validated


@pytest.mark.parametrize("size", [[40.0, 30.0], [40.0, 30.0, 20.0]])
def test_joints_along_a_side_soften_the_rock_beyond_it(size):
    """lambda = mu = 20 GPa, joints 2 m apart along the bottom: 1/M = 1/60e9 + 1/(2 x 1e10) and
    1/mu = 1/20e9 + 1/(2 x 4e9), Z = sqrt(rho M) and sqrt(rho mu); in space for both S waves."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9, "dip": 0.0, "spacing": 2.0}
    tables = {
        "title": "quiet sides",
        "domain": {"size": size},
        "rock": {"density": 2500.0, "intact_modulus": 5e10, "intact_poisson": 0.25},
        "joint_sets": [{"name": "layers", **law}],
        "time": {"duration": 0.01},
        "record": {"points": [[1.0] * len(size)]},
    }
    scene = validated(tables, Path("scene.toml"), frozenset())
    down = -np.eye(len(size))[-1:]
    expected = np.sqrt([2500 / (1 / 60e9 + 1 / 20e9), 2500 / (1 / 20e9 + 1 / 8e9)])
    found = impedances(scene, down, np.array([-1]))
    tensor = np.diag(np.append(np.full(len(size) - 1, expected[1]), expected[0]))
    np.testing.assert_allclose(found, [tensor], rtol=1e-12, atol=1e-9 * expected[0])
