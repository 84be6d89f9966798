"""Joints that slip lifts, in round numbers worked out by hand, and what physics allows them.

K = 1e9, K_s = 2e9 Pa/m, tan(phi) = 0.5; tan(psi) from 0.2 to none over 1 mm: w = 0.1 mm at most.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from jointwave.joints.dilation import lift, lift_rate, riding_stiffness
from jointwave.joints.energy import elastic_energy, friction_work, lift_work
from jointwave.joints.law import Law
from tests.joints.points import Point, advance, at_point, tangent

JOINT = Law(1e9, shear_stiffness=2e9, friction=0.5, dilation=0.2, dilation_distance=1e-3)
DT = 1e-5
EPS = np.finfo(float).eps


def step(one, gap, x, history, rate=0.0):
    """Return normal and shear traction (Pa) and the history after a slip by x, m."""
    t_n, t_x, _, after = advance(*at_point(one), gap, rate, (x, 0.0), (x / DT, 0.0), DT, history)
    return t_n, t_x, after


@pytest.mark.parametrize(
    ("path", "up", "rate"), [(0.0, 0.0, 0.2), (5e-4, 7.5e-5, 0.1), (1e-3, 1e-4, 0.0), (1, 1e-4, 0)]
)
def test_lift_over_the_path(path, up, rate):
    law, _ = at_point(JOINT)
    assert lift(law, path) == pytest.approx(up) and lift_rate(law, path) == pytest.approx(rate)


def test_a_confined_joint_is_pressed_by_its_slip():
    """Held at 1 MPa, then slid to S = 0.5 mm: lifted by 0.075 mm, 1.075 MPa, 0.5375 MPa in shear,
    which is 0.26875 mm of the spring's slip. In one step, or in ten to the same place."""
    x = 5e-4 + 5.375e5 / 2e9
    for count in (1, 10):
        h = Point()
        for _ in range(count):
            t_n, t_x, h = step(JOINT, -1e-3, x / count, h)
        assert (t_n, t_x, h.path) == pytest.approx((1.075e6, -5.375e5, 5e-4), rel=1e-12)
    for _ in range(3):  # there and back: worn off, the faces stay up
        t_n, _, h = step(JOINT, -1e-3, -5e-3, h)
    assert t_n == pytest.approx(1.1e6) and h.path > 1e-3


def test_a_joint_under_constant_stress_opens():
    """1 MPa kept by opening it as it is lifted: no more shear than 0.5 MPa, and the way is w."""
    h, up = Point(), 0.0
    for _ in range(100):
        t_n, _, after = step(JOINT, -1e-3 + up, 2e-5, h)
        up = lift(at_point(JOINT)[0], after.path)
        t_n, t_x, h = step(JOINT, -1e-3 + up, 2e-5, h)
    assert up == pytest.approx(1e-4) and t_n == pytest.approx(1e6) and -t_x == pytest.approx(5e5)


def test_an_open_joint_is_not_lifted():
    """Faces that do not touch ride up nothing; lifted ones touch before the gap is closed."""
    one = JOINT._replace(carries_tension=False)
    assert step(one, 1e-6, 1e-2, Point())[2].path == 0.0
    worn = Point(path=1e-3)
    assert step(one, 1.01e-4, 0.0, worn)[0] == 0.0
    assert step(one, 0.9e-4, 0.0, worn)[0] == pytest.approx(1e4)


def test_slip_acts_on_the_normal_traction_within_a_step():
    """At S = 0.5 mm: w' = 0.1; b = 2e9 + 0.5 1e9 0.1. dl = K_s dx / b, d t_n = 1e9 0.1 dl."""
    x = 5e-4 + 5.375e5 / 2e9
    found = tangent(*at_point(JOINT), -1e-3, 0.0, (x, 0.0), (0.0, 0.0), DT, Point(), 0.0)
    b = 2.05e9
    assert found.nx == pytest.approx(1e8 * 2e9 / b, rel=1e-9)
    assert found.xx == pytest.approx(-2e9 * (1 - 2e9 / b), rel=1e-9)
    assert found.nn == pytest.approx(-1e9 + 1e8 * 5e8 / b, rel=1e-9)
    assert found.xn == pytest.approx(2e9 / b * 5e8, rel=1e-9)


def some(low, high):
    """Return floats in a range, rounded."""
    return st.floats(low, high).map(lambda x: round(x, 9))


@st.composite
def laws(draw):
    """Return a joint that dilates by less than its friction, damped, open, closing or weakening."""
    friction, weakens, viscous = draw(some(0.01, 2)), draw(st.booleans()), draw(st.booleans())
    dynamic, closes = friction * draw(some(0, 1)), draw(st.booleans())
    eta = 1e-4 * draw(some(0.001, 1)) if viscous else None
    return Law(
        normal_stiffness=9e9,
        normal_viscosity=eta and 9e9 * eta,
        carries_tension=False,
        shear_stiffness=3e9,
        shear_viscosity=eta and 3e9 * eta,
        cohesion=1e5 * draw(some(0, 1)),
        friction=friction,
        maximum_closure=3e-4 if closes else None,
        dynamic_friction=dynamic if weakens else None,
        weakening_distance=1e-4 * draw(some(0.1, 10)) if weakens else None,
        dilation=(dynamic if weakens else friction) * draw(some(0, 1)),
        dilation_distance=1e-4 * draw(some(0.1, 10)),
    )


# gap, mostly closed, and slip in x and z: 0.1 mm each.
paths = st.lists(st.tuples(some(-1, 0.3), some(-1, 1), some(-1, 1)), min_size=1, max_size=12)


def march(one, path):
    """Yield (gap before, gap, slip, tractions, history before, after) of each step."""
    point, h, last = at_point(one), Point(0.0, 0.0, 0.0, one.cohesion), 0.0
    for gap, x, z in path:
        gap, slip = gap * 1e-4, np.array([x, z]) * 1e-4
        before = h
        *t, h = advance(*point, gap, (gap - last) / DT, tuple(slip), tuple(slip / DT), DT, before)
        yield last, gap, slip, np.array(t), before, h
        last = gap


def stored(one, gap, h):
    """Return the energy in the springs, J/m2."""
    law, parts = at_point(one)
    return elastic_energy(law, parts, gap - lift(law, h.path), h.opening, h.ex, h.ez)


@given(laws(), paths)
def test_no_step_creates_energy(one, path):
    """Work on the joint over a step, of the tractions at its end, >= change of what is stored: both
    energies are convex, dashpots and slides take the rest. So a closed cycle of slip, under
    whatever prestress, gives nothing: what is stored is of the state alone."""
    work, size, first = 0.0, 0.0, None
    for last, gap, slip, t, before, h in march(one, path):
        first = stored(one, last, before) if first is None else first
        own = -t[0] * (gap - last) - t[1:] @ slip
        change = stored(one, gap, h) - stored(one, last, before)
        size += np.abs(t).sum() * 4e-4 + abs(change)
        steep = 1e6 if one.maximum_closure is not None else 1.0
        assert own >= change - 1e-12 * steep * size
        work += own
    assert work >= stored(one, gap, h) - first - 1e-11 * steep * size


@given(laws(), paths)
def test_what_slides_dissipates(one, path):
    """The strength over the slide less what the lift takes, t_n dw, is not negative: the angle of
    dilation is at most that of friction. The traction at the end of a step bounds its lift."""
    law, _ = at_point(one)
    for _, _, _, t, before, h in march(one, path):
        slide = h.path - before.path
        up = lift(law, h.path) - lift(law, before.path)
        assert up >= 0 and slide >= 0
        tau, rate = np.hypot(*t[1:]), max(t[0], 0.0) * lift_rate(law, before.path)
        # w' falls along the step: the lift is at most that of its beginning.
        assert up <= lift_rate(law, before.path) * slide * (1 + 1e-9) + 1e-18
        spent = tau * slide - max(t[0], 0.0) * up
        assert spent >= -1e-9 * (tau + rate) * slide - 1e-9 * one.friction * max(t[0], 0) * slide


@given(paths)
def test_the_ledger_of_a_linear_joint_is_a_trapezoid(path):
    """Mean spring tractions times the way = change of stored energy + friction - lift, while it
    stays closed."""
    path, law = [(-abs(g) - 3.0, x, z) for g, x, z in path], at_point(JOINT)
    cohesive = JOINT._replace(cohesion=1e3)
    last_t = None
    for last, gap, slip, t, before, h in march(cohesive, path):
        if last_t is None:
            last_t = t
            continue
        normal = -0.5 * (last_t[0] + t[0]) * (gap - last)
        e, old = np.array([h.ex, h.ez]), np.array([before.ex, before.ez])
        shear = 0.5 * 2e9 * (e + old) @ slip
        lifted = [lift(law[0], one.path) for one in (before, h)]
        spent = friction_work(law[0], *old, *e, *slip)
        spent -= lift_work(
            *law, last - lifted[0], gap - lifted[1], h.opening, lifted[1] - lifted[0]
        )
        change = stored(cohesive, gap, h) - stored(cohesive, last, before)
        size = 1e9 * (abs(gap) + abs(last)) ** 2 + 2e9 * np.abs(slip).sum() ** 2 + 2e9 * e @ e
        assert normal + shear == pytest.approx(change + spent, abs=1e-12 * size)
        last_t = t


@given(some(0, 3), some(0, 1), some(0.01, 10), some(0.01, 100))
def test_the_critical_step_covers_a_joint_that_rides_up(friction, share, shear, mass):
    """The eigenvalue of the tangent while it slides, against masses 1 and m, is at most that of the
    springs that stand for it."""
    t = friction * share
    sliding = np.array([[1.0, -t], [-friction, friction * t]])
    eigenvalue = np.abs(np.linalg.eigvals(sliding / np.array([[1.0], [mass]]))).max()
    springs = np.diag(np.array(riding_stiffness(t, friction, 1.0, shear), dtype=float))
    assert eigenvalue <= eigh(springs, np.diag([1.0, mass]), eigvals_only=True)[-1] * (1 + 1e-9)
