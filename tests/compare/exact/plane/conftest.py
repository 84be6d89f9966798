"""Shared by several tests of waves in jointed rock in plane strain."""

import numpy as np
import pytest

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint


@pytest.fixture
def rock():
    """Return rock of nu = 0.25."""
    return ElasticRock(2600.0, 3000.0 * np.sqrt(3.0), 3000.0)


@pytest.fixture
def joint(rock):
    """Return the joint K_n = Z_p omega, K_s = Z_s omega at 100 Hz."""
    omega = 2 * np.pi * 100.0
    return Joint(rock.p_impedance * omega, rock.s_impedance * omega)
