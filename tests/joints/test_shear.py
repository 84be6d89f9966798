"""What physics allows the shear traction: Coulomb's surface, dissipation, cohesion lost once."""

from math import cos, hypot, sin

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from jointwave.joints.energy import elastic_energy, friction_work
from jointwave.joints.law import Law
from jointwave.joints.shear import UNLIMITED, shear_return, shear_strength
from jointwave.joints.softening import strength_left
from jointwave.joints.weakening import friction_left
from tests.joints.points import Point, advance, at_point

DT = 1e-5
EPS = np.finfo(float).eps


def some(low, high):
    """Return floats in a range; rounded, as the square of a number below 1e-162 is zero."""
    return st.floats(low, high).map(lambda x: round(x, 9))


@st.composite
def laws(draw):
    """Return a Coulomb law with residual cohesion, tied, without tension or softening.

    Its friction may fall with slip, faster than the joint unloads or not.
    """
    stiffness, viscous = 1e9 * draw(some(0.1, 100)), draw(st.booleans())
    how = draw(st.sampled_from(["ties", "no tension", "softening"]))
    cohesion, friction, weakens = 1e6 * draw(some(0, 1)), draw(some(0, 2)), draw(st.booleans())
    return Law(
        normal_stiffness=9e9,
        carries_tension=False if how == "no tension" else None,
        shear_stiffness=stiffness,
        shear_viscosity=stiffness * 1e-4 * draw(some(0.001, 10)) if viscous else None,
        cohesion=cohesion,
        friction=friction,
        residual_cohesion=cohesion * draw(some(0, 1)),
        tensile_strength=2e5 if how == "softening" else None,
        critical_opening=1e-3 if how == "softening" else None,
        dynamic_friction=friction * draw(some(0, 1)) if weakens else None,
        weakening_distance=1e-4 * draw(some(0.01, 10)) if weakens else None,
    )


# gap, mostly closed, and slip in x and z: 0.1 mm each.
steps = st.lists(st.tuples(some(-1, 0.3), some(-1, 1), some(-1, 1)), min_size=1, max_size=20)


def march(one, path):
    """Yield (gap, slip, t_n, traction, history before, after) of each step of a path of slips."""
    point, h = at_point(one), Point(0.0, 0.0, 0.0, one.cohesion)
    for gap, x, z in path:
        gap, slip = gap * 1e-4, np.array([x, z]) * 1e-4
        before, rate = h, slip / DT
        t_n, t_x, t_z, h = advance(*point, gap, 0.0, tuple(slip), tuple(rate), DT, before)
        yield gap, slip, t_n, np.array([t_x, t_z]), before, h


def elastic(h):
    """Return the elastic slip of a history as an array, m."""
    return np.array([h.ex, h.ez])


def magnitude(one, slip, before):
    """Return the sum of magnitudes that a step's traction is computed from, Pa."""
    stiffness = one.shear_stiffness + (one.shear_viscosity or 0.0) / DT
    return stiffness * (np.abs(elastic(before)).sum() + np.abs(slip).sum())


def steepness(one, t_n):
    """Return what the strength loses per path over the stiffness that unloads."""
    if one.weakening_distance is None:
        return 0.0
    return max(t_n, 0.0) * one.friction / one.weakening_distance / one.shear_stiffness


@given(laws(), steps)
def test_traction_stays_on_or_inside_the_surface(one, path):
    """|T| <= c s(k) / s_t + t_n tan(phi); open without tension nothing, whatever the cohesion."""
    for gap, slip, t_n, t, before, h in march(one, path):
        c = before.cohesion
        if one.tensile_strength is not None:
            c *= strength_left(one, h.opening) / one.tensile_strength
        tau = max(c + t_n * friction_left(*at_point(one), t_n, h.path), 0.0)
        if one.carries_tension is False and gap > 0:
            tau = 0.0
        # Where friction falls, by the slide and what round-off of the path makes of it.
        off = 1e-14 * magnitude(one, slip, before) * steepness(one, t_n)
        assert hypot(*t) <= tau * (1 + 8 * EPS) + off


@given(laws(), steps)
def test_spring_and_dashpot_carry_the_traction(one, path):
    """At the end of every step, slipped or not: T = -K_s e - C_s (e - e_old) / dt."""
    for _, slip, _, t, before, h in march(one, path):
        e, old = elastic(h), elastic(before)
        carried = -one.shear_stiffness * e - (one.shear_viscosity or 0.0) * (e - old) / DT
        assert t == pytest.approx(carried, abs=1e-14 * magnitude(one, slip, before))


@given(laws(), steps)
def test_no_step_creates_energy_and_slide_only_dissipates(one, path):
    """Work of the traction over a step >= change of elastic energy; of it, T . slide <= 0.

    The elastic energy is convex in e, so the traction at the end of the step bounds its change
    from above at any size of step; dashpot and slide take the rest.
    """
    for _, slip, _, t, before, h in march(one, path):
        e, old = elastic(h), elastic(before)
        slide = slip - (e - old)
        scale = magnitude(one, slip, before)
        scale *= np.abs(slip).sum() + np.abs(e).sum() + np.abs(old).sum()
        change = one.shear_stiffness * (e @ e - old @ old) / 2
        assert -t @ slip >= change - 1e-14 * scale
        assert t @ slide <= 1e-14 * scale


@given(laws(), steps)
def test_friction_work_closes_the_trapezoid(one, path):
    """Mean spring force times the slip = change of elastic energy + friction work."""
    for _, slip, _, _, before, h in march(one, path):
        e, old = elastic(h), elastic(before)
        work = one.shear_stiffness * (e + old) / 2 @ slip
        point = at_point(one)
        stored = elastic_energy(*point, 0.0, 0.0, *e) - elastic_energy(*point, 0.0, 0.0, *old)
        taken = friction_work(one, *old, *e, *slip)
        scale = one.shear_stiffness * (np.abs(e) + np.abs(old) + np.abs(slip)).sum() ** 2
        assert work == pytest.approx(stored + taken, abs=1e-14 * scale)


@given(laws(), steps)
def test_cohesion_is_lost_once_and_for_all(one, path):
    """A point has its cohesion until its first slip, and the residual one ever after."""
    lost = False
    for _, slip, _, _, before, h in march(one, path):
        slide = np.abs(slip - (elastic(h) - elastic(before))).sum()
        assert h.cohesion in (one.cohesion, one.residual_cohesion)
        # A slide above round-off is a slip; a slip may be below it.
        clear = slide > 1e-12 * (np.abs(slip).sum() + np.abs(elastic(before)).sum())
        lost = lost or clear or h.cohesion != one.cohesion
        assert h.cohesion == (one.residual_cohesion if lost else one.cohesion)


@given(laws(), steps)
def test_friction_falls_with_the_path_and_the_path_only_grows(one, path):
    """The path is that of the slides of pressed faces, to the dashpots' share of a step; friction
    is between its ends."""
    assume(one.weakening_distance is not None)
    for _, slip, t_n, _, before, h in march(one, path):
        slide = hypot(*(slip - (elastic(h) - elastic(before))))
        expected = slide if t_n > 0 else 0.0
        off = 1e-13 * magnitude(one, slip, before) / one.shear_stiffness + 1e-13 * h.path
        assert h.path - before.path == pytest.approx(expected, abs=off)
        left = [friction_left(*at_point(one), 1.0, at.path) for at in (before, h)]
        assert one.dynamic_friction * (1 - EPS) <= left[1] <= left[0] <= one.friction * (1 + EPS)


@given(laws(), steps, some(0, 6.3))
def test_no_direction_is_preferred(one, path, angle):
    """Slips turned about the normal give tractions turned with them."""
    turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    turned = [(gap, *(turn @ (x, z))) for gap, x, z in path]
    one = one._replace(residual_cohesion=one.cohesion)  # or round-off decides on the edge of slip
    if one.weakening_distance is not None:  # and where a joint snaps; this one's does not halve
        most = 2 * steepness(one, 9e5) * one.weakening_distance
        one = one._replace(weakening_distance=max(one.weakening_distance, most))
    scale = 0.0
    for straight, other in zip(march(one, path), march(one, turned), strict=True):
        scale += magnitude(one, straight[1], straight[4])
        assert other[3] == pytest.approx(turn @ straight[3], abs=1e-13 * scale)


@given(some(0.1, 100), some(0.01, 1), some(1.1, 20))
def test_cyclic_slip_takes_four_tau_times_the_slide(stiffness, tau, ratio):
    """Between +s and -s a Coulomb joint takes 4 tau (s - tau / K_s) in a cycle, in one step a leg.

    The spring force is linear up to the strength and constant from there, so the energy taken is
    the end-of-step traction times the slide: exact in a single step.
    """
    one = Law(9e9, shear_stiffness=1e9 * stiffness, cohesion=1e6 * tau, friction=0.0)
    tau, s = one.cohesion, ratio * one.cohesion / one.shear_stiffness
    point, taken, e = at_point(one), [], 0.0
    for slip in (s, -2 * s, 2 * s):
        strength = shear_strength(*point, 0.0, 0.0, 0.0, 0.0, 0.0)
        t, _, after, _, _ = shear_return(
            *point, e + slip, 0.0, e, 0.0, slip / DT, 0.0, strength, DT
        )
        taken.append(-t * (slip - (after - e)))
        e = after
    assert sum(taken[1:]) == pytest.approx(4 * tau * (s - tau / one.shear_stiffness), rel=1e-12)


def test_nothing_limits_a_tied_joint_without_strength():
    """The whole traction, however large, where nothing can slide."""
    plain = at_point(Law(9e9, shear_stiffness=3e9))
    assert shear_strength(*plain, 1e6, -1e-4, 0.0, 0.0, 0.0) == UNLIMITED
    huge = 2 * UNLIMITED / 3e9
    found = advance(*plain, -1e-4, 0.0, (huge, 0.0), (0.0, 0.0), DT, Point())
    assert found[1:3] == (pytest.approx(-2 * UNLIMITED, rel=1e-15), 0.0)
