"""The joint with rate-and-state friction, against its known behaviour in simple cases."""

import numpy as np
import pytest
from scipy.optimize import brentq

from jointwave.cases.histories import Ricker, Step
from jointwave.compare.exact.joint.rate_state_joint import RateJoint, RateStateWave

Z = 2e6  # Pa s/m
JOINT = RateJoint(1e6, 0.6, 0.01, 0.015, 1e-4, 1e-6, 100.0)


@pytest.mark.parametrize("compliance", [0.0, 1e-10])
def test_steady_slip_under_a_step(compliance):
    """2 (sigma_I - s) / Z is the rate in the end, s that of steady friction at it."""
    times, joint = np.linspace(0.0, 0.03, 301), JOINT._replace(compliance=compliance)
    stress, impulse = RateStateWave(joint, Z, Step(1e6), 0.03, 1e-10)(times)

    def left(rate):
        return 1e6 - Z * rate / 2 - 1e6 * (0.6 - 0.005 * np.log(rate / 1e-6))

    rate = brentq(left, 1e-3, 1.0)
    assert stress[-1] == pytest.approx(1e6 - Z * rate / 2, rel=1e-7)
    slip = 2 * (1e6 * times - impulse) / Z
    assert np.diff(slip)[-1] / np.diff(times)[-1] == pytest.approx(rate, rel=1e-6)


def test_the_impulse_is_that_of_the_stress():
    """Two ways to the same number: S is integrated, the stress follows from ln theta only."""
    times = np.linspace(0.0, 0.03, 60_001)
    for compliance in (0.0, 1e-10):
        joint = JOINT._replace(compliance=compliance)
        stress, impulse = RateStateWave(joint, Z, Ricker(1e6, 0.01), 0.03, 1e-11)(times)
        sums = np.append(0.0, np.cumsum((stress[1:] + stress[:-1]) / 2 * np.diff(times)))
        np.testing.assert_allclose(impulse, sums, rtol=0, atol=1e-6 * np.abs(impulse).max())


def test_a_stiff_joint_tends_to_a_rigid_one():
    """As fast as its compliance falls."""
    times, errors = np.linspace(0.0, 0.03, 301), []
    rigid = RateStateWave(JOINT, Z, Ricker(1e6, 0.01), 0.03, 1e-10)(times)[0]
    for compliance in (4e-11, 2e-11):
        joint = JOINT._replace(compliance=compliance)
        stress = RateStateWave(joint, Z, Ricker(1e6, 0.01), 0.03, 1e-10)(times)[0]
        errors.append(np.abs(stress - rigid).mean())
    assert errors[1] < 0.52 * errors[0] and errors[1] < 0.01 * 1e6


def test_what_it_carries_solves_its_equation():
    """From nothing to a hundred times the strength, and its opposite."""
    incident = np.append(0.0, np.geomspace(1e-6, 1e8, 300))
    carries, slides = np.vectorize(JOINT.carries), np.vectorize(JOINT.slides)
    for log_state in (-20.0, 0.0, 10.0):
        stress = carries(incident, log_state, Z)
        left = stress + Z / 2 * slides(stress, log_state) - incident
        assert np.abs(left).max() <= 1e-11 * 1e8 and (np.diff(stress) > 0).all()
        assert (carries(-incident, log_state, Z) == -stress).all()


@pytest.mark.parametrize("log_state", [-1e5, 1e5])
@pytest.mark.parametrize("incident", [1e-320, 1e8])
def test_what_it_carries_is_finite_where_a_trial_step_is_too_long(incident, log_state):
    """Integration tries states of no meaning: exponentials beyond all numbers."""
    stress = JOINT.carries(incident, log_state, Z)
    assert 0 <= stress <= incident and np.isfinite(JOINT.slides(stress, log_state))
