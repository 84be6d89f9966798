"""The law of a joint in round numbers, each worked out by hand: tractions, memory and energies.

Both engines share the law, and its plain twin was written beside it: what both say wrongly shows
here alone. K = 1e9 Pa/m, K_s = 2e9 Pa/m; softening from 1e5 Pa at w_0 = 0.1 mm to none at 0.3 mm.
"""

from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from jointwave.joints.closure import closure_stiffness, closure_traction, closure_under
from jointwave.joints.dilation import riding_stiffness
from jointwave.joints.energy import elastic_energy, fracture_energy_spent, friction_work
from jointwave.joints.law import Law, law
from jointwave.joints.normal import gap_under, spring_traction
from tests.joints.points import DT, Point, advance, at_point, some

K, K_S = 1e9, 2e9
SOFTENING = Law(K, 1e4, tensile_strength=1e5, critical_opening=3e-4)
COULOMB = Law(K, None, False, K_S, None, 3e4, 0.5, 1e4)
RUBS, DRAGS = Law(K, shear_stiffness=K_S, friction=0.5), Law(K, 1e4, False, K_S, 2e4, 1e4)
BREAKS = Law(K, None, None, K_S, None, 3e4, tensile_strength=1e5, critical_opening=3e-4)
ROOT = 15.08**0.5  # of 2.2^2 + 3.2^2


def near(value):
    """Hold a number to round-off."""
    return pytest.approx(value, rel=1e-12, abs=1e-9)


def step(one, gap, slip=(0.0, 0.0), rate=0.0, h=None):
    """Return what the law says of one step from a history, dashpots at the rate of the slip."""
    slip_rate = slip[0] / DT, slip[1] / DT
    return advance(*at_point(one), gap, rate, slip, slip_rate, DT, h or Point())


@pytest.mark.parametrize(
    ("one", "gap", "rate", "opening", "expected"),
    [
        (Law(K), -1e-4, 7.0, 0.0, 1e5),  # closed by 0.1 mm
        (Law(K), 1e-4, 7.0, 0.0, -1e5),  # pulled
        (Law(K, 1e4), -1e-4, -3.0, 0.0, 1.3e5),  # closing at 3 m/s: 3e4 Pa more
        (Law(K, 1e4, False), -1e-4, 3.0, 0.0, 7e4),
        (Law(K, 1e4, False), -1e-4, 12.0, 0.0, 0.0),  # the dashpot alone would pull by 2e4 Pa
        (Law(K, 1e4, False), 1e-6, -50.0, 0.0, 0.0),  # open, and closing fast
        (Law(K, 1e4, True), 1e-4, 3.0, 0.0, -1.3e5),
        (Law(K, 1e4, False), 0.0, -3.0, 0.0, 3e4),  # just closed
        (SOFTENING, 5e-5, 2.0, 5e-5, -7e4),  # below w_0: K, and the dashpot's 2e4 Pa
        (SOFTENING, 1e-4, 2.0, 1e-4, -1e5),  # never more than the strength
        (SOFTENING, 2e-4, 2.0, 2e-4, -5e4),
        (SOFTENING, 1e-4, 2.0, 2e-4, -3e4),  # half the way back: half, a quarter of the dashpot
        (SOFTENING, -1e-4, 2.0, 2e-4, 8e4),  # closed: whole again
        (SOFTENING, 1e-4, 2.0, 3e-4, 0.0),
    ],
)
def test_normal_traction(one, gap, rate, opening, expected):
    """It unloads through the origin once it softened, the dashpot less by the same share."""
    t_n, *shear, after = step(one, gap, rate=rate, h=Point(opening))
    assert (t_n, *shear) == near((expected, 0.0, 0.0))
    assert after.opening == (max(gap, opening) if one is SOFTENING else after.opening)


@pytest.mark.parametrize(
    ("one", "gap", "slip", "before", "expected", "after"),
    [
        # |T| = 2e9 * 5 um = 1e4 Pa < 3e4 + 0.5 * 1e5: elastic.
        (COULOMB, -1e-4, (3e-6, 4e-6), Point(cohesion=3e4), (-6e3, -8e3), (3e-6, 4e-6, 3e4)),
        # 0.1 mm along (3, 4) / 5 would need 2e5 Pa; 3e4 + 0.5 * 1e5 = 8e4 Pa holds, then 6e4.
        (COULOMB, -1e-4, (6e-5, 8e-5), Point(cohesion=3e4), (-4.8e4, -6.4e4), (24e-6, 32e-6, 1e4)),
        (COULOMB, -1e-4, (0.0, 0.0), Point(0.0, 24e-6, 32e-6, 1e4), (-3.6e4, -4.8e4),
         (18e-6, 24e-6, 1e4)),
        (COULOMB, 1e-7, (3e-6, 0.0), Point(0.0, 1e-6, 0.0, 3e4), (0.0, 0.0), (0.0, 0.0, 1e4)),
        # Friction alone: 0.5 of 1e5 Pa; pulled, nothing.
        (RUBS, -1e-4, (1e-3, 0.0), Point(), (-5e4, 0.0), (25e-6, 0.0, 0.0)),
        (RUBS, 1e-4, (1e-3, 0.0), Point(), (0.0, 0.0), (0.0, 0.0, 0.0)),
        # C_s = 2e4 Pa s/m at 0.1 m/s adds 2e3 Pa to 2e9 * 1 um.
        (DRAGS, -1e-4, (1e-6, 0.0), Point(), (-4e3, 0.0), (1e-6, 0.0, 0.0)),
        # On the strength both carry 1e4 Pa over the step: e = (0 + 1e4 / 2e9) / 2.
        (DRAGS, -1e-4, (1e-5, 0.0), Point(), (-1e4, 0.0), (2.5e-6, 0.0, 0.0)),
        # From e = (1, 0) um by (5, 8) um: T* = 2e9 (6, 8) um + 2e4 (0.5, 0.8) m/s = (2.2, 3.2) 1e4.
        (DRAGS, -1e-4, (5e-6, 8e-6), Point(0.0, 1e-6), (-2.2e4 / ROOT, -3.2e4 / ROOT),
         ((1e-6 + 1.1e-5 / ROOT) / 2, 8e-6 / ROOT, 0.0)),
        # Half the tensile strength left is half the cohesion, 1.5e4 Pa; friction takes 0.1 * 5e4.
        (BREAKS, 2e-4, (1e-3, 0.0), Point(2e-4), (-1.5e4, 0.0), (7.5e-6, 0.0, 0.0)),
        (BREAKS._replace(friction=0.1), 2e-4, (1e-3, 0.0), Point(2e-4), (-1e4, 0.0),
         (5e-6, 0.0, 0.0)),
        (BREAKS, 3e-4, (1e-3, 0.0), Point(3e-4), (0.0, 0.0), (0.0, 0.0, 0.0)),
    ],
)  # fmt: skip
def test_shear_traction(one, gap, slip, before, expected, after):
    """Against the slip, and along it where it is returned; the first slip takes the cohesion."""
    _, *found, h = step(one, gap, slip, h=before)
    assert found == near(expected)
    assert (h.ex, h.ez, h.cohesion) == near(after)


def test_energies():
    """K g^2 / 2 = 5 J/m2 closed or pulled; K_s e^2 / 2 = 25 mJ/m2; open without tension nothing.
    Sliding at a constant 2e5 Pa over 0.3 mm takes 60 J/m2; from 0 to it, by the mean, half.
    Opening spends G_c = 1e5 * 3e-4 / 2 = 15 J/m2, in proportion to the opening beyond w_0."""

    def stored(one, gap, opening=0.0, ex=0.0, ez=0.0):
        return elastic_energy(*at_point(one), gap, opening, ex, ez)

    assert stored(Law(K), -1e-4) == stored(Law(K), 1e-4) == near(5.0)
    assert stored(Law(K, None, False), 1e-4) == 0
    assert stored(Law(K, None, None, K_S), 0.0, 0.0, 3e-6, 4e-6) == near(0.025)
    assert stored(SOFTENING, 2e-4, 2e-4) == near(5.0)  # 5e4 * 2e-4 / 2
    assert stored(SOFTENING, 1e-4, 2e-4) == near(1.25)
    one = Law(K, None, None, K_S)
    assert friction_work(one, 1e-4, 0.0, 1e-4, 0.0, 3e-4, 0.0) == near(60.0)
    assert friction_work(one, 0.0, 0.0, 0.0, 1e-4, 0.0, 4e-4) == near(30.0)
    for opening, spent in ((1e-4, 0.0), (1.5e-4, 3.75), (2e-4, 7.5), (3e-4, 15.0), (5e-4, 15.0)):
        assert fracture_energy_spent(SOFTENING, opening) == near(spent)


@given(some(0.1, 100), some(0.01, 1), some(1.1, 20))
def test_cyclic_slip_takes_four_tau_times_the_slide(stiffness, tau, ratio):
    """Between +s and -s a Coulomb joint takes 4 tau (s - tau / K_s) in a cycle, in one step a leg.

    The spring force is linear up to the strength and constant from there, so the energy taken is
    the end-of-step traction times the slide: exact in a single step."""
    one = Law(9e9, shear_stiffness=1e9 * stiffness, cohesion=1e6 * tau, friction=0.0)
    tau, s = one.cohesion, ratio * one.cohesion / one.shear_stiffness
    taken, h = [], Point()
    for slip in (s, -2 * s, 2 * s):
        _, t, _, after = step(one, 0.0, (slip, 0.0), h=h)
        taken.append(-t * (slip - (after.ex - h.ex)))
        h = after
    assert sum(taken[1:]) == pytest.approx(4 * tau * (s - tau / one.shear_stiffness), rel=1e-12)


#: Under 1 MPa: tan(phi) from 0.6 to 0.2 over 1 mm, so that the strength falls by 4e8 Pa/m.
WEAKENS = Law(K, shear_stiffness=K_S, friction=0.6, dynamic_friction=0.2, weakening_distance=1e-3)
PRESSED = -1e-3  # m


@pytest.mark.parametrize(
    ("x", "path", "stress"),
    [
        (2e-4, 0.0, 4e5),  # it holds
        (3e-4, 0.0, 6e5),
        (7e-4, 5e-4, 4e5),  # 1.4e6 - 6e5 = (2e9 - 4e8) 5e-4
        (1.1e-3, 1e-3, 2e5),
        (4e-3, 3.9e-3, 2e5),
    ],
)
def test_friction_that_weakens(x, path, stress):
    """tau = 6e5 - 4e8 S, of S = x - tau / 2e9: in one step, or in two to the same place."""
    for count in (1, 2):
        h = Point()
        for _ in range(count):
            _, t, _, h = step(WEAKENS, PRESSED, (x / count, 0.0), h=h)
        assert (t, h.path) == pytest.approx((-stress, path), rel=1e-12, abs=1e-15)


def test_the_path_grows_whatever_the_direction_and_of_pressed_faces_alone():
    """There by 0.5 mm and back by another: the strength is 4e5, then 2e5 Pa. What moves while it is
    open, or is pulled, is no path."""
    h = step(WEAKENS, PRESSED, (7e-4, 0.0))[3]
    _, t, _, h = step(WEAKENS, PRESSED, (-8e-4, 0.0), h=h)  # 4e5 to -2e5 Pa unloads by 0.3 mm
    assert (t, h.path) == pytest.approx((2e5, 1e-3), rel=1e-12)
    assert step(WEAKENS._replace(carries_tension=False), 1e-6, (1.0, 0.0))[3].path == 0.0
    _, t, _, h = step(WEAKENS._replace(cohesion=1e5), 1e-5, (1e-3, 0.0))  # pulled by 1e4 Pa
    assert t == pytest.approx(-9.4e4) and h.path == 0.0  # 1e5 - 0.6e4


def test_a_joint_softer_than_its_friction_falls_snaps():
    """Over 0.1 mm: 4e9 Pa/m. Just beyond 6e5 Pa it falls to 2e5 Pa, and slides by the 0.2 mm that
    its spring of 2e9 Pa/m gives back."""
    steep = WEAKENS._replace(weakening_distance=1e-4)
    assert step(steep, PRESSED, (3e-4 * (1 - 1e-9), 0.0))[1] == pytest.approx(-6e5, rel=1e-8)
    _, t, _, after = step(steep, PRESSED, (3e-4 * (1 + 1e-9), 0.0))
    assert (t, after.path) == pytest.approx((-2e5, 2e-4), rel=1e-8)


#: tan(psi) from 0.2 to none over 1 mm: lifted by w = 0.1 mm at most.
LIFTS = Law(K, shear_stiffness=K_S, friction=0.5, dilation=0.2, dilation_distance=1e-3)


def test_a_confined_joint_is_pressed_by_its_slip():
    """Held at 1 MPa, then slid to S = 0.5 mm: lifted by 0.075 mm, 1.075 MPa, 0.5375 MPa in shear,
    which is 0.26875 mm of the spring's slip. In one step, or in ten to the same place."""
    x = 5e-4 + 5.375e5 / K_S
    for count in (1, 10):
        h = Point()
        for _ in range(count):
            t_n, t_x, _, h = step(LIFTS, PRESSED, (x / count, 0.0), h=h)
        assert (t_n, t_x, h.path) == pytest.approx((1.075e6, -5.375e5, 5e-4), rel=1e-12)
    for _ in range(3):  # there and back: worn off, the faces stay up
        t_n, _, _, h = step(LIFTS, PRESSED, (-5e-3, 0.0), h=h)
    assert t_n == pytest.approx(1.1e6) and h.path > 1e-3


def test_an_open_joint_is_not_lifted():
    """Faces that do not touch ride up nothing; lifted ones touch before the gap is closed."""
    one, worn = LIFTS._replace(carries_tension=False), Point(path=1e-3)
    assert step(one, 1e-6, (1e-2, 0.0))[3].path == 0.0
    assert step(one, 1.01e-4, h=worn)[0] == 0.0
    assert step(one, 0.9e-4, h=worn)[0] == pytest.approx(1e4)


@given(some(0, 3), some(0, 1), some(0.01, 10), some(0.01, 100))
def test_the_critical_step_covers_a_joint_that_rides_up(friction, share, shear, mass):
    """The eigenvalue of the tangent while it slides, against masses 1 and m, is at most that of the
    springs that stand for it."""
    t = friction * share
    sliding = np.array([[1.0, -t], [-friction, friction * t]])
    eigenvalue = np.abs(np.linalg.eigvals(sliding / np.array([[1.0], [mass]]))).max()
    springs = np.diag(np.array(riding_stiffness(t, friction, 1.0, shear), dtype=float))
    assert eigenvalue <= eigh(springs, np.diag([1.0, mass]), eigvals_only=True)[-1] * (1 + 1e-9)


#: k_ni = 1e9 Pa/m and d_m = 0.1 mm: s_m = 1e5 Pa. Half of d_m takes s_m, nine tenths 9 s_m. A
#: millionth of its own compliance, that the joint keeps, is all that differs from that: 1.1e-4
#: where it is up to a hundred times as stiff as at first.
CLOSES = Law(K, maximum_closure=1e-4)
#: 0.3 of the joint's own compliance is the rock's.
IN_ROCK = Law(K, 1e4, maximum_closure=1e-4, rock_compliance=0.3e-9)
BUT_A_MILLIONTH = {"rel": 1.1e-4}


@pytest.mark.parametrize(
    ("gap", "expected", "energy"),
    [
        (-5e-5, 1e5, 10 * (log(2) - 0.5)),
        (-9e-5, 9e5, 10 * (log(10) - 0.9)),
        (-1e-12, 1e-3, 0.5e-15),
        (2e-5, -2e4, 0.2),  # open: linear
    ],
)
def test_the_hyperbola(gap, expected, energy):
    """k_ni d / (1 - d / d_m) and k_ni d_m^2 (-ln(1 - d / d_m) - d / d_m)."""
    point = at_point(CLOSES)
    assert spring_traction(*point, gap, 0.0) == pytest.approx(expected, **BUT_A_MILLIONTH)
    stored = elastic_energy(*point, gap, 0.0, 0.0, 0.0)
    assert stored == pytest.approx(energy, **BUT_A_MILLIONTH)


def test_beyond_its_maximum_a_joint_is_a_million_times_as_stiff():
    """A step that would pass d_m gives a finite, larger traction: a wall, not a singularity."""
    gaps = -1e-4 * np.array([0.999, 1.0, 1.001, 1.1, 2.0, 1e3, 1e9])
    t = np.array([spring_traction(*at_point(CLOSES), gap, 0.0) for gap in gaps])
    assert np.isfinite(t).all() and (np.diff(t) > 0).all()
    steepest = np.diff(t[3:]) / -np.diff(gaps[3:])
    assert steepest == pytest.approx(1e15, rel=2e-2) and (steepest <= 1e15 * (1 + 1e-9)).all()


closures = st.floats(1e-9, 1e2)  # of d_m


@given(closures, closures, st.sampled_from([CLOSES, IN_ROCK]))
def test_stored_energy_of_closure_is_the_work_whatever_the_way(a, b, one):
    """From a to b by Gauss in the logarithm of the traction; back it is the same with the other
    sign, for the joint unloads along its curve."""
    point = at_point(one)
    t = [closure_traction(point[0], x * 1e-4) for x in (a, b)]
    nodes, weights = np.polynomial.legendre.leggauss(120)
    at = np.exp(np.log(t[0]) + (nodes + 1) / 2 * np.log(t[1] / t[0]))
    work = np.log(t[1] / t[0]) / 2 * weights @ (at**2 / closure_stiffness(point[0], at))
    stored = [elastic_energy(*point, -x * 1e-4, 0.0, 0.0, 0.0) for x in (a, b)]
    assert min(stored) >= 0
    assert stored[1] - stored[0] == pytest.approx(work, rel=1e-9, abs=1e-11 * max(stored))


@given(st.floats(1e-6, 1e8), st.sampled_from([CLOSES, IN_ROCK]))
def test_the_gap_of_a_traction_is_the_inverse(t, one):
    """To the round-off of a steep curve."""
    point = at_point(one)
    gap = gap_under(*point, t)
    off = 1e-14 * abs(gap) * closure_stiffness(point[0], t)
    assert spring_traction(*point, gap, 0.0) == pytest.approx(t, rel=1e-13, abs=off)
    assert closure_under(point[0], t) == -gap
    assert gap_under(*point, -t) == t / K


def test_the_law_of_joints():
    """One number where all are alike, an array where they differ, nothing where no joint has a
    part; viscosity is K eta."""
    stiffness, alike = np.array([1e9, 4e8]), {"shear_stiffness": 5e8, "cohesion": 3e4}
    alike |= {"friction": 0.5, "tensile_strength": 1e5, "critical_opening": 3e-4}
    given = {name: np.full(2, value) for name, value in alike.items()}
    one = law(stiffness, np.array([1e-5, 2e-5]), np.array([True, False]), **given)
    assert one.normal_stiffness.tolist() == stiffness.tolist()
    assert one.normal_viscosity == near(np.array([1e4, 8e3]))
    assert one.shear_viscosity == near(np.array([5e3, 1e4]))
    assert one.carries_tension.tolist() == [True, False]
    assert {name: getattr(one, name) for name in alike} == alike
    assert one.residual_cohesion is one.dilation is None
    plain = law(np.full(2, K), None, np.ones(2, bool), **given)
    assert plain == Law(K, **alike)
    assert law(np.full(2, K), None, np.zeros(2, bool)) == Law(K, carries_tension=False)
