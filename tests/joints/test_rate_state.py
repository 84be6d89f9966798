"""Friction that depends on rate and state, against what its two equations say in closed form.

1 MPa on the joint; mu_0 = 0.6 at 1e-6 m/s, a = 0.01, b = 0.015, D_c = 0.1 mm."""

from math import exp, log, log1p

import numpy as np
import pytest

from jointwave.joints.law import Law
from jointwave.joints.rate_state import exponent, friction_at
from tests.joints.points import Point, advance, at_point

PRESSURE, LENGTH, RATE = 1e6, 1e-4, 1e-6
JOINT = Law(
    1e9,
    shear_stiffness=1e12,
    friction=0.6,
    direct_effect=0.01,
    evolution_effect=0.015,
    critical_slip_distance=LENGTH,
    reference_rate=RATE,
    initial_state=LENGTH / RATE,
)
PRESSED = -1e-3  # m: 1 MPa


def driven(one, rate, dt, steps, h):
    """Yield the shear traction (Pa) and history of a joint whose faces are moved at a rate, m/s."""
    point, slip = at_point(one), (rate * dt, 0.0)
    for _ in range(steps):
        _, t, _, h = advance(*point, PRESSED, 0.0, slip, (rate, 0.0), dt, h)
        yield -t, h


def steady(one, rate):
    """Return the history of steady slip at a rate, m/s."""
    law, _ = at_point(one)
    state = log(LENGTH / rate / law.initial_state)
    friction = friction_at(law, log(rate) + exponent(law, state))
    elastic = PRESSURE * friction / law.shear_stiffness
    return Point(0.0, elastic, 0.0, 0.0, state)


def test_a_step_of_the_rate_has_its_direct_and_its_evolution_effect():
    """From 1e-6 to 1e-5 m/s: up by a ln 10 at once, then with theta = theta_2 + (theta_1 -
    theta_2) exp(-V t / D_c), which the integration has exactly, to (a - b) ln 10. The spring of
    1e12 Pa/m gives way by 0.023 MPa / K = 2.3e-8 m in all, so that the slip lags 2.3e-4 D_c, and
    friction by b of that; slip per step is 1e-3 D_c."""
    fast = 10 * RATE
    moved = driven(JOINT, fast, 0.01, 10_000, steady(JOINT, RATE))
    found = [t / PRESSURE for t, _ in moved]
    x = fast * 0.01 * np.arange(1, 10_001) / LENGTH
    theta = 1 + (10 - 1) * np.exp(-x)  # over D_c / V
    expected = 0.6 + 0.01 * log(10) + 0.015 * np.log(theta / 10)
    # The first steps move the spring: a ln 10 PRESSURE / K is 2.3e-8 m of slip, 0.23 of a step.
    np.testing.assert_allclose(found[3:], expected[3:], atol=0.015 * 1e-3)
    # What is left of theta's way is 9 e^-10.
    assert found[-1] == pytest.approx(0.6 - 0.005 * log(10), abs=0.015 * 9.1 * exp(-10))
    assert max(found) == pytest.approx(0.6 + 0.01 * log(10), abs=0.015 * 5e-3)


@pytest.mark.parametrize("rate", [1e-12, 1e-9, 1e-6, 1e-3, 1.0])
def test_steady_friction(rate):
    """mu_0 + (a - b) ln(V / V_0), to the digits of the regularisation, e^(-2 mu / a)."""
    dt = 1e-2 * LENGTH / rate
    *_, (t, h) = driven(JOINT, rate, dt, 100, steady(JOINT, rate))
    assert t / PRESSURE == pytest.approx(0.6 - 0.005 * log(rate / RATE), abs=1e-9)
    assert h.path == pytest.approx(log(RATE / rate), abs=1e-9)


def test_contacts_that_rest_grow_older():
    """theta = theta_0 + t exactly, in steps of any length; faces apart, or pulled, do not age."""
    for steps in (1, 1000):
        *_, (_, h) = driven(JOINT, 0.0, 5e3 / steps, steps, Point())
        assert h.path == pytest.approx(log1p(50.0), rel=1e-12)
    for gap in (0.0, 1e-5):
        one = at_point(JOINT)
        assert advance(*one, gap, 0.0, (1e-6, 0.0), (0.0, 0.0), 1.0, Point())[3].path == 0.0


@pytest.mark.parametrize("share", [0.8, 1.0, 1.25])
def test_the_critical_stiffness_of_steady_slip(share):
    """Slip driven at V by a spring k without inertia: near its steady state it goes like
    exp(p V t / D_c), a p^2 + (a - b + k D_c / s) p + k D_c / s = 0, so that it is stable above
    k_c = s (b - a) / D_c (Ruina 1983), and at k_c oscillates with p^2 = -k_c D_c / (s a).

    Ten units of time, from a state 0.1 % too old: to 1 % of that, to first order."""
    a, b, k = 0.01, 0.015, share * 0.005
    one = JOINT._replace(shear_stiffness=k * PRESSURE / LENGTH)
    h = steady(one, RATE)
    h = h._replace(path=h.path + 1e-3)
    roots = np.roots([a, a - b + k, k])
    # From the state and tau as given: tau = s (a v + b w), w' = -(v + w), v = -(b / a) w at first.
    both = np.array([[1.0, 1.0], roots])
    weights = np.linalg.solve(both, [1e-3, (b / a - 1) * 1e-3])
    found = []
    for steps in (4000, 8000):
        states = [one.path for _, one in driven(one, RATE, 10 * LENGTH / RATE / steps, steps, h)]
        found.append(np.array(states)[:: steps // 4000][-3000::600])
        times = 10 * np.arange(1, steps + 1, steps // 4000)[-3000::600] / steps
        expected = (np.exp(np.outer(times, roots)) @ weights).real
        found[-1] -= expected
    assert np.abs(2 * found[1] - found[0]).max() < 0.02 * np.abs(found[0]).max() + 3e-6
    assert np.abs(found[1]).max() < 1e-5
    growing = roots.real.max()
    assert np.sign(round(growing, 12)) == np.sign(1 - share)


@pytest.mark.parametrize("effect", [1e-6, 1e-4, 0.1])
@pytest.mark.parametrize("size", [1e-290, 1e-3, 1e5, 6e5, 1e9, 1e15])
@pytest.mark.parametrize("state", [-60.0, 0.0, 60.0])
@pytest.mark.parametrize("dt", [1e-12, 1e-5, 1e5])
def test_any_size_has_a_finite_answer(effect, size, state, dt):
    """Between nothing and the trial traction, as friction under it and the state are defined."""
    one = JOINT._replace(direct_effect=effect, evolution_effect=2 * effect)
    h = Point(ex=size / 1e12, path=state)
    _, t, _, after = advance(*at_point(one), PRESSED, 0.0, (0.0, 0.0), (0.0, 0.0), dt, h)
    assert 0 <= -t <= size * (1 + 1e-12)
    assert np.isfinite(after.path)
