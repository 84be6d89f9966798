"""The dashpot behind a spring, by hand and against its harmonic response."""

from math import inf

import numpy as np
import pytest

from jointwave.joints.ends import half_spring


def test_by_hand():
    """k = 4, eta = 1/4, Z = 2, dt = 1/2: share = 1 / (1 + 4 / 4 / 2), lag = 4 / 2 * share / 4.
    Behind an infinite dashpot, a rigid wall, the closure is the mass's displacement."""
    expected = (8 / 3, 2 / 3, 0.5, 0.25, 16 / 9)
    assert half_spring(4.0, 0.25, 2.0, 0.5) == pytest.approx(expected, rel=1e-12)
    wall = half_spring(k=3.0, eta=0.1, z=inf, dt=0.2)
    assert wall == (3.0, pytest.approx(0.3), 1.0, pytest.approx(0.2), 3.0)


@pytest.mark.parametrize("eta", [0.0, 0.02])
def test_reaction_to_a_harmonic_is_second_order(eta):
    """f / v = Z k (1 + i w eta) / (k (1 + i w eta) + i w Z), approached at order 2 in the step."""
    k, z, omega, errors = 40.0, 5.0, 7.0, []
    spring = k * (1 + 1j * omega * eta)
    exact = z * spring / (spring + 1j * omega * z)
    for dt in (1e-2, 5e-3):
        end = half_spring(k, eta, z, dt)
        turn = np.exp(1j * omega * dt)
        w = end.gain * np.sqrt(turn) / (turn - end.decay)  # the closure at whole steps
        errors.append(abs(end.stiffness * w + end.viscosity * np.cos(omega * dt / 2) - exact))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)
