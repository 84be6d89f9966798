"""The matrix-exponential integrator against scipy's exact one for piecewise linear loads."""

import numpy as np
from scipy.signal import lsim

from jointwave.cases.histories import Recorded, Step
from jointwave.compare.exact.linear import twins

A = np.array([[0.0, 3.0], [-3.0, -0.4]])
B = np.array([0.5, 1.0])


def test_breaks_between_samples_are_integrated_exactly():
    """lsim is exact where the load is linear between its samples, here at sixths of ours."""
    times = np.linspace(0, 12, 61)
    load = Recorded(
        np.array([0.1, 1.0, 1.1, 1.1 + 1 / 30, 7.0]), np.array([0.0, 3.0, -1.0, 2.0, 0])
    )
    fine = np.linspace(0, 12, 361)
    _, expected, _ = lsim((A, B[:, None], np.eye(2), np.zeros((2, 1))), load.value(fine), fine)
    found = twins(A, B, load, times)[0]
    assert np.abs(found - expected[::6]).max() < 1e-12


def test_a_step_settles_at_the_static_solution():
    times = np.linspace(0, 200, 41)
    found = twins(A, B, Step(2.0), times)[0]
    assert np.allclose(found[-1], -np.linalg.solve(A, 2 * B), atol=1e-12)
