"""Friction that depends on rate and state, against what its two equations say in closed form.

1 MPa on the joint; mu_0 = 0.6 at 1e-6 m/s, a = 0.01, b = 0.015, D_c = 0.1 mm.
"""

from math import asinh, exp, log, log1p

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.joints.energy import elastic_energy, friction_work
from jointwave.joints.law import Law
from jointwave.joints.rate_state import exponent, friction_at, rate_under
from tests.joints.points import Point, advance, at_point, tangent

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


def friction_under(law, rate, state):
    """Return mu of ln V (V in m/s) and s."""
    return friction_at(law, rate + exponent(law, state))


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
    elastic = PRESSURE * friction_under(law, log(rate), state) / law.shear_stiffness
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


def test_friction_and_rate_are_each_other_s_inverse():
    """And the formula as it is written, where no number of it overflows."""
    law, _ = at_point(JOINT)
    for rate in (1e-30, 1e-18, 1e-6, 1.0):
        for state in (-10.0, 0.0, 5.0):
            known = (0.6 + 0.015 * state) / 0.01
            expected = 0.01 * asinh(rate / (2 * RATE) * exp(known))
            found = friction_under(law, log(rate), state)
            assert found == pytest.approx(expected, rel=1e-12)
            assert rate_under(law, found, state) == pytest.approx(log(rate), rel=1e-11)


@pytest.mark.parametrize("share", [0.8, 1.0, 1.25])
def test_the_critical_stiffness_of_steady_slip(share):
    """Slip driven at V by a spring k without inertia: near its steady state it goes like
    exp(p V t / D_c), a p^2 + (a - b + k D_c / s) p + k D_c / s = 0, so that it is stable above
    k_c = s (b - a) / D_c (Ruina 1983), and at k_c oscillates with p^2 = -k_c D_c / (s a).

    Ten units of time, from a state 0.1 % too old: to 1 % of that, by backward differences of first
    order."""
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


def some(low, high):
    """Return floats in a range, rounded."""
    return st.floats(low, high).map(lambda x: round(x, 9))


@st.composite
def laws(draw):
    """Return a joint with or without dashpots and cohesion, stiff enough to have one root."""
    b, eta = 0.03 * draw(some(0, 1)), 1e-4 * draw(some(0.001, 1))
    viscous = draw(st.booleans())
    return JOINT._replace(
        shear_stiffness=3e9,
        normal_viscosity=1e9 * eta if viscous else None,
        shear_viscosity=3e9 * eta if viscous else None,
        carries_tension=False,
        cohesion=1e5 * draw(some(0, 1)),
        direct_effect=0.03 * draw(some(0.01, 1)),
        evolution_effect=b,
        initial_state=10 ** draw(st.floats(-4, 4)),
    )


# gap, mostly closed, and slip in x and z: 0.1 mm each.
moves = st.lists(st.tuples(some(-1, 0.3), some(-1, 1), some(-1, 1)), min_size=1, max_size=12)
DT = 1e-5


def march(one, moves, turn=0.0):
    """Yield the tractions, slip, and histories around each step, of slips turned by an angle."""
    point, h, last = at_point(one), Point(0.0, 0.0, 0.0, one.cohesion or 0.0), 0.0
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    for gap, x, z in moves:
        gap, slip, before = 1e-4 * gap, turned @ (1e-4 * np.array([x, z])), h
        step = gap, (gap - last) / DT, tuple(slip), tuple(slip / DT)
        *t, h = advance(*point, *step, DT, before)
        yield step, np.array(t), before, h
        last = gap


@given(laws(), moves)
def test_no_step_creates_energy(one, moves):
    """Work of the shear tractions at the end of a step >= change of what is stored, a convex
    energy; what slides takes part of it, along the traction."""
    law, parts = at_point(one)
    for (_, _, slip, _), t, before, h in march(one, moves):
        stored = [elastic_energy(law, parts, 0.0, 0.0, e.ex, e.ez) for e in (before, h)]
        work, size = -t[1:] @ slip, np.abs(t[1:]).sum() * 2e-4 + sum(stored)
        assert work >= stored[1] - stored[0] - 1e-12 * size
        slide = np.array(slip) - [h.ex - before.ex, h.ez - before.ez]
        assert -t[1:] @ slide >= -1e-12 * size


@given(laws(), moves)
def test_the_ledger_is_a_trapezoid(one, moves):
    """Mean spring traction times slip = change of stored energy + friction, exactly."""
    law, parts = at_point(one)
    for (_, _, slip, _), _, before, h in march(one, moves):
        e, old = np.array([h.ex, h.ez]), np.array([before.ex, before.ez])
        work = 0.5 * 3e9 * (e + old) @ slip
        stored = [elastic_energy(law, parts, 0.0, 0.0, *x) for x in (old, e)]
        spent = friction_work(law, *old, *e, *slip)
        size = 3e9 * (np.abs(slip).sum() + np.abs(e).sum() + np.abs(old).sum()) ** 2
        assert work == pytest.approx(stored[1] - stored[0] + spent, abs=1e-13 * size)


@given(laws(), moves, st.floats(-np.pi, np.pi))
def test_no_direction_along_the_joint_is_special(one, moves, angle):
    """Slips turned in the plane of the joint turn the tractions, and leave the states alone."""
    turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for (_, t, _, h), (_, other, _, found) in zip(
        march(one, moves), march(one, moves, angle), strict=True
    ):
        size = np.abs(t).max() + 3e9 * 1e-4 + (one.shear_viscosity or 0.0) * 10
        assert other[0] == t[0]
        np.testing.assert_allclose(other[1:], turned @ t[1:], rtol=0, atol=1e-10 * size)
        assert found.path == pytest.approx(h.path, abs=1e-8)


@given(laws(), moves)
def test_a_slide_takes_stiffness_away(one, moves):
    """What a step resists to slip is never more than spring and dashpot do without it: the critical
    step of leapfrog is that of the joint at rest."""
    point, before = at_point(one), Point(0.0, 0.0, 0.0, one.cohesion)
    for (*step, slip, rate), _, before, _ in march(one, moves):
        found = tangent(*point, *step, slip, rate, DT, before, 0.0)
        stiffness = np.linalg.eigvalsh([[-found.xx, -found.xz], [-found.xz, -found.zz]])
        assert stiffness[-1] <= 3e9 * (1 + 1e-9)


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
