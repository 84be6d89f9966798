"""The dashpot behind a spring, against the limits that it must have."""

from math import inf

import numpy as np
import pytest

from jointwave.joints.ends import half_spring


def test_rigid_wall_adds_up_the_motion():
    """Behind an infinite dashpot the closure is the mass's displacement."""
    end = half_spring(k=3.0, eta=0.1, z=inf, dt=0.2)
    assert end == (3.0, pytest.approx(0.3), 1.0, pytest.approx(0.2), 3.0)


def test_stiff_spring_is_the_dashpot_itself():
    """Held at velocity v, a stiff spring comes to the reaction Z v."""
    end = half_spring(k=1e12, eta=0.0, z=5.0, dt=1e-3)
    w = end.gain / (1 - end.decay) * 1.0
    assert end.stiffness * w == pytest.approx(5.0, rel=1e-9)


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
