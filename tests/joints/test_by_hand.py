"""The law of a joint in round numbers, each worked out by hand: tractions, memory and energies.

Both engines share the law, and its plain twin was written beside it: what both say wrongly shows
here alone. K = 1e9 Pa/m, K_s = 2e9 Pa/m; softening from 1e5 Pa at w_0 = 0.1 mm to none at 0.3 mm.
"""

from math import sqrt

import numpy as np
import pytest

from jointwave.joints.ends import half_spring
from jointwave.joints.energy import elastic_energy, fracture_energy_spent, friction_work
from jointwave.joints.law import Law, law, uniform
from jointwave.joints.normal import normal_traction, spring_traction
from jointwave.joints.shear import UNLIMITED, shear_return
from jointwave.joints.softening import is_broken, strength_left
from jointwave.numerics.critical_step import critical_step, critical_step_of_modes
from tests.joints.points import Point, advance, at_point, tangent

K, K_S, DT = 1e9, 2e9, 1e-5
VIRGIN = Point()
SOFTENING = Law(K, 1e4, tensile_strength=1e5, critical_opening=3e-4)
COULOMB = Law(K, None, False, K_S, None, 3e4, 0.5, 1e4)


def near(value):
    """Hold a number to round-off."""
    return pytest.approx(value, rel=1e-12, abs=1e-9)


def step(one, gap, slip=(0.0, 0.0), gap_rate=0.0, slip_rate=(0.0, 0.0), h=VIRGIN):
    """Return what the law says of one step from a history."""
    return advance(*at_point(one), gap, gap_rate, slip, slip_rate, DT, h)


@pytest.mark.parametrize(
    ("one", "gap", "rate", "expected"),
    [
        (Law(K), -1e-4, 7.0, 1e5),  # closed by 0.1 mm
        (Law(K), 1e-4, 7.0, -1e5),  # pulled
        (Law(K, 1e4), -1e-4, -3.0, 1.3e5),  # closing at 3 m/s: 3e4 Pa more
        (Law(K, 1e4), -1e-4, 3.0, 7e4),
        (Law(K, 1e4, False), -1e-4, 3.0, 7e4),
        (Law(K, 1e4, False), -1e-4, 12.0, 0.0),  # the dashpot alone would pull by 2e4 Pa
        (Law(K, 1e4, False), 1e-6, -50.0, 0.0),  # open, and closing fast
        (Law(K, 1e4, True), 1e-4, 3.0, -1.3e5),
        (Law(K, 1e4, False), 0.0, -3.0, 3e4),  # just closed
    ],
)
def test_normal_traction(one, gap, rate, expected):
    assert normal_traction(*at_point(one), gap, rate, 0.0) == near(expected)


@pytest.mark.parametrize(
    ("opening", "left"),
    [(0.0, 1e5), (1e-4, 1e5), (1.5e-4, 7.5e4), (2e-4, 5e4), (3e-4, 0.0), (9e-4, 0.0)],
)
def test_strength_left(opening, left):
    """On the line from 1e5 Pa at 0.1 mm to nothing at 0.3 mm."""
    assert strength_left(SOFTENING, opening) == near(left)
    assert is_broken(*at_point(SOFTENING), opening) == (left == 0)


@pytest.mark.parametrize(
    ("gap", "opening", "spring", "whole"),
    [
        (5e-5, 5e-5, -5e4, -7e4),  # below w_0: K, and the dashpot of 2 m/s, 2e4 Pa
        (1e-4, 1e-4, -1e5, -1e5),  # never more than the strength
        (2e-4, 2e-4, -5e4, -5e4),
        (1e-4, 2e-4, -2.5e4, -3e4),  # half the way back: half of it, a quarter of the dashpot
        (-1e-4, 2e-4, 1e5, 8e4),  # closed: whole again
        (1e-4, 3e-4, 0.0, 0.0),
    ],
)
def test_softening(gap, opening, spring, whole):
    """Unloads through the origin, the dashpot less by the same share."""
    assert spring_traction(*at_point(SOFTENING), gap, opening) == near(spring)
    assert normal_traction(*at_point(SOFTENING), gap, 2.0, opening) == near(whole)


def test_a_joint_remembers_its_largest_opening():
    h = Point(1e-4)
    for gap, expected in ((2e-4, 2e-4), (-1e-4, 2e-4), (1.5e-4, 2e-4), (2.5e-4, 2.5e-4)):
        _, t_x, t_z, h = step(SOFTENING, gap, h=h)
        assert h == (expected, 0.0, 0.0, 0.0, 0.0) and t_x == t_z == 0


def test_shear_below_the_strength_is_elastic():
    """|T| = 2e9 * 5 um = 1e4 Pa < 3e4 + 0.5 * 1e5; cohesion stays what it is."""
    t_n, t_x, t_z, h = step(COULOMB, -1e-4, (3e-6, 4e-6), h=Point(0.0, 0.0, 0.0, 3e4))
    assert (t_n, t_x, t_z) == near((1e5, -6e3, -8e3))
    assert (h.ex, h.ez, h.cohesion) == near((3e-6, 4e-6, 3e4))


def test_slip_returns_along_its_own_direction_and_takes_the_cohesion():
    """0.1 mm along (3, 4) / 5 would need 2e5 Pa; 3e4 + 0.5 * 1e5 = 8e4 Pa holds, then 1e4."""
    t_n, t_x, t_z, h = step(COULOMB, -1e-4, (6e-5, 8e-5), h=Point(0.0, 0.0, 0.0, 3e4))
    assert (t_n, t_x, t_z) == near((1e5, -4.8e4, -6.4e4))
    assert (h.ex, h.ez, h.cohesion) == near((2.4e-5, 3.2e-5, 1e4))
    _, t_x, t_z, h = step(COULOMB, -1e-4, (0.0, 0.0), h=h)
    assert (t_x, t_z) == near((-3.6e4, -4.8e4))  # 6e4 Pa
    assert (h.ex, h.ez, h.cohesion) == near((1.8e-5, 2.4e-5, 1e4))


def test_shear_of_an_open_joint_is_nothing():
    _, t_x, t_z, h = step(COULOMB, 1e-7, (3e-6, 0.0), h=Point(0.0, 1e-6, 0.0, 3e4))
    assert (t_x, t_z, h.ex, h.ez) == (0, 0, 0, 0)


def test_dashpot_in_shear():
    """C_s = 2e4: 0.2 m/s adds 4e3 Pa to 2e9 * 1 um; on the strength of 1e4 Pa spring and dashpot
    over the step carry it: (2e4 / 1e-5 * e + T) / (2e9 + 2e4 / 1e-5), that is (e + T / 2e9)
    / 2 with e before the step."""
    one = Law(K, 1e4, False, K_S, 2e4, 1e4)
    h = Point(0.0, 0.0, 0.0)
    _, t_x, _, after = step(one, -1e-4, (1e-6, 0.0), slip_rate=(0.2, 0.0), h=h)
    assert (t_x, after.ex) == near((-6e3, 1e-6))
    _, t_x, _, after = step(one, -1e-4, (1e-5, 0.0), slip_rate=(1.0, 0.0), h=h)
    assert (t_x, after.ex) == near((-1e4, 2.5e-6))
    h = Point(0.0, 1e-6, 2e-6)  # with the slip 10 and 40 / 3 um
    rate = (0.9, 34 / 30)  # of the slip in 10 us; T* = 2e9 * (10, 40 / 3) um + 2e4 * rate
    _, t_x, t_z, after = step(one, -1e-4, (9e-6, 34e-6 / 3), slip_rate=rate, h=h)
    trial = 2e4 + 1.8e4, 8e4 / 3 + 6.8e4 / 3
    share = 1e4 / sqrt(trial[0] ** 2 + trial[1] ** 2)
    assert (t_x, t_z) == near((-share * trial[0], -share * trial[1]))
    assert (after.ex, after.ez) == near(((1e-6 - t_x / 2e9) / 2, (2e-6 - t_z / 2e9) / 2))


def test_friction_alone():
    """0.5 of 1e5 Pa; pulled, nothing."""
    one = Law(K, None, None, K_S, None, None, 0.5)
    assert step(one, -1e-4, (1e-3, 0.0), h=Point(0.0, 0.0, 0.0))[1] == near(-5e4)
    assert step(one, 1e-4, (1e-3, 0.0), h=Point(0.0, 0.0, 0.0))[1] == 0


def test_shear_that_nothing_limits():
    found = shear_return(
        *at_point(Law(K, None, None, K_S)), 1e-6, 2e-6, 0.0, 0.0, 0.0, 0.0, UNLIMITED, DT
    )
    assert found[:4] == near((-2e3, -4e3, 1e-6, 2e-6)) and not found[4]


def test_softened_cohesion():
    """Half the tensile strength left is half the cohesion: 1.5e4 Pa, with friction of -5e4 Pa
    nothing."""
    one = Law(K, None, None, K_S, None, 3e4, None, None, 1e5, 3e-4)
    h = Point(2e-4, 0.0, 0.0)
    assert step(one, 2e-4, (1e-3, 0.0), h=h)[1] == near(-1.5e4)
    assert step(one._replace(friction=0.5), 2e-4, (1e-3, 0.0), h=h)[1] == 0
    assert step(one._replace(friction=0.1), 2e-4, (1e-3, 0.0), h=h)[1] == near(-1e4)
    assert step(one, 3e-4, (1e-3, 0.0), h=h)[1] == 0


def test_energies():
    """K g^2 / 2 = 5 J/m2 closed or pulled; K_s e^2 / 2 = 25 mJ/m2; open without tension nothing."""

    def stored(one, gap, opening=0.0, ex=0.0, ez=0.0):
        return elastic_energy(*at_point(one), gap, opening, ex, ez)

    assert stored(Law(K), -1e-4) == stored(Law(K), 1e-4) == near(5.0)
    assert stored(Law(K, None, False), 1e-4) == 0
    assert stored(Law(K, None, None, K_S), 0.0, 0.0, 3e-6, 4e-6) == near(0.025)
    assert stored(SOFTENING, 2e-4, 2e-4) == near(5.0)  # 5e4 * 2e-4 / 2
    assert stored(SOFTENING, 1e-4, 2e-4) == near(1.25)


def test_work_of_sliding():
    """At a constant 2e5 Pa over 0.3 mm 60 J/m2; from 0 to it, by the mean of both, half."""
    one = Law(K, None, None, K_S)
    assert friction_work(one, 1e-4, 0.0, 1e-4, 0.0, 3e-4, 0.0) == near(60.0)
    assert friction_work(one, 0.0, 1e-4, 0.0, 1e-4, 0.0, 3e-4) == near(60.0)
    assert friction_work(one, 0.0, 0.0, 1e-4, 0.0, 4e-4, 0.0) == near(30.0)
    assert friction_work(one, 0.0, 0.0, 1e-4, 1e-4, 1e-4, 1e-4) == 0


@pytest.mark.parametrize(
    ("opening", "spent"), [(1e-4, 0.0), (1.5e-4, 3.75), (2e-4, 7.5), (3e-4, 15.0), (5e-4, 15.0)]
)
def test_fracture_energy(opening, spent):
    """Of G_c = 1e5 * 3e-4 / 2 = 15 J/m2, in proportion to the opening beyond w_0."""
    assert fracture_energy_spent(SOFTENING, opening) == near(spent)


def test_tangent_of_a_joint_that_slips():
    """T = tau n with n = (3, 4) / 5 and |T*| = 2e5: K_s tau / |T*| = 8e8 across n, nothing along
    it; tau follows the normal traction by 0.5 * -1e9."""
    one = COULOMB._replace(residual_cohesion=None)
    found = tangent(
        *at_point(one), -1e-4, 0.0, (6e-5, 8e-5), (0.0, 0.0), DT, Point(0.0, 0.0, 0.0), 0.0
    )
    assert found.nn == near(-1e9)
    # The traction is against the slip: T = -tau n, so its growth with tau is, too.
    assert (found.xn, found.zn) == near((3e8, 4e8))
    assert (found.xx, found.xz, found.zz) == near((-8e8 * 0.64, 8e8 * 0.48, -8e8 * 0.36))


def test_tangent_counts_a_dashpot_as_a_spring():
    """r = 1e4 / s: K + 1e4 * 1e4 Pa s/m, K_s + 1e4 * 2e4."""
    one = Law(K, 1e4, None, K_S, 2e4)
    found = tangent(
        *at_point(one), -1e-4, 0.0, (0.0, 0.0), (0.0, 0.0), DT, Point(0.0, 0.0, 0.0), 1e4
    )
    assert (found.nn, found.xx, found.xz, found.zz) == near((-1.1e9, -2.2e9, 0, -2.2e9))


def test_tangent_of_a_softening_joint():
    """Opening further falls by 1e5 / 0.2 mm; unloading goes by the secant, 5e4 / 0.2 mm."""
    one = SOFTENING._replace(normal_viscosity=None)
    for before, slope in ((1.5e-4, 5e8), (2e-4, -2.5e8), (4e-4, 0.0)):
        found = tangent(*at_point(one), 2e-4, 0.0, (0.0, 0.0), (0.0, 0.0), DT, Point(before), 0.0)
        assert found.nn == near(slope)


def test_tangent_of_a_cohesion_that_softens():
    """It falls by 3e4 / 1e5 of the strength's 5e8 Pa/m, and the traction too."""
    one = Law(K, None, None, K_S, None, 3e4, None, None, 1e5, 3e-4)
    for before, rise in ((1.5e-4, 1.5e8), (2.5e-4, 0.0)):
        h = Point(before, 0.0, 0.0)
        assert tangent(*at_point(one), 2e-4, 0.0, (1e-3, 0.0), (0.0, 0.0), DT, h, 0.0).xn == near(
            rise
        )


def test_dashpot_behind_a_spring():
    """k = 4, eta = 1/4, Z = 2, dt = 1/2: share = 1 / (1 + 4 / 4 / 2), lag = 4 / 2 * share / 4."""
    end = half_spring(4.0, 0.25, 2.0, 0.5)
    assert end == near((8 / 3, 2 / 3, 0.5, 0.25, 16 / 9))
    assert half_spring(4.0, 0.25) == (4.0, 1.0, 1.0, 0.0, 4.0)


def test_critical_step():
    """omega = 10: 0.2 s; eta = 0.15 s: sqrt(4 * 0.15^2 + 4 / 100) - 0.3 = sqrt(0.13) - 0.3; of
    1.5 ms: sqrt(0.040009) - 0.003."""
    damped = sqrt(0.13) - 0.3
    assert critical_step_of_modes(10.0, 0.15) == near(damped)
    assert critical_step_of_modes(10.0, 0.0) == near(0.2)
    assert critical_step(lambda a, b: 100 * a + 15 * b, True) == near(damped)
    assert critical_step(lambda a, b: 100 * a + 0.15 * b, True) == near(sqrt(0.040009) - 0.003)
    assert critical_step(lambda a, b: 100 * a + 0 * b, True) == near(0.2)
    assert critical_step(lambda a, b: 100 * a + 15 * b, False) == near(0.2)


def test_the_law_of_joints():
    """One number where all are alike, an array where they differ; viscosity is K eta."""
    stiffness = np.array([1e9, 1e9, 4e8])
    one = law(
        stiffness,
        np.array([1e-5, 2e-5, 2e-5]),
        np.array([True, False, True]),
        shear_stiffness=np.array([5e8, 5e8, 5e8]),
        cohesion=np.array([3e4, 3e4, 3e4]),
    )
    assert one.normal_stiffness.tolist() == stiffness.tolist()
    assert one.normal_viscosity == near(np.array([1e4, 2e4, 8e3]))
    assert one.shear_viscosity == near(np.array([5e3, 1e4, 1e4]))
    assert one.carries_tension.tolist() == [True, False, True]
    assert (one.shear_stiffness, one.cohesion) == (5e8, 3e4)
    assert one.friction is one.residual_cohesion is one.tensile_strength is None
    strengths = {"friction": 0.5, "residual_cohesion": 1e4, "tensile_strength": 1e5}
    strengths["critical_opening"] = 3e-4
    found = law(
        stiffness, None, np.ones(3, bool), **{k: np.full(3, v) for k, v in strengths.items()}
    )
    assert {k: getattr(found, k) for k in strengths} == strengths
    assert found.carries_tension is found.shear_stiffness is found.normal_viscosity is None
    assert law(stiffness, None, np.zeros(3, bool)).carries_tension is False
    assert uniform(np.array([])).size == 0
