"""The tangent of the joint law against differences of the law itself, and at its kinks exactly."""

from functools import cache, partial
from itertools import product
from math import hypot

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from jointwave.joints.closure import closing, closure_stiffness
from jointwave.joints.dilation import lift
from jointwave.joints.law import Law
from jointwave.joints.normal import dashpot, normal_tangent, normal_traction, spring_alone
from jointwave.joints.shear import shear_strength, shear_traction
from jointwave.joints.softening import stiffness_left, strength_left
from tests.joints.points import DT, Point, advance, at_point, some, tangent

EPS = np.finfo(float).eps
SHARE = 1e-5  # step of a central difference, of the length over which the law bends

# What limits the shear traction, by letter: cohesion, friction, residual cohesion, dynamic friction
# with its weakening distance, dilation (i) with its distance. None: no shear. R: friction that
# depends on rate and state.
SHEARS = (None, "", "c", "f", "cf", "cfr", "fdw", "cfrdw", "fi", "cfdwi", "fR", "cfrR")
COMBINATIONS = [
    *product(("", "dashpots"), ("ties", "no tension", "softening"), SHEARS),
    *product(("", "dashpots"), ("closes", "closes, no tension", "closes, softening"), (None, "cf")),
]
some = cache(partial(some, digits=6))


@st.composite
def one_law(draw, dashpots, opens, shears):
    """Return a law of these parts, its history before a step, and the rate factor of the step."""
    k, eta, parts = 1e9 * draw(some(0.1, 10)), 1e-4 * draw(some(0.01, 10)), {}
    cohesion, before = 1e5 * draw(some(0, 2)), 0.0
    if "closes" in opens:
        parts.update(maximum_closure=1e-4 * draw(some(0.1, 10)))
        parts.update(rock_compliance=draw(some(0.01, 0.9)) / k)
        parts.update(rock_time_constant=draw(some(0, 1)) * eta)
    if "softening" in opens:
        first, ductility = draw(some(0.01, 0.5)) * 1e-4, draw(some(1.1, 100))
        parts.update(tensile_strength=k * first, critical_opening=ductility * first)
        before = draw(some(0, 1.2)) * ductility * first
    if shears is not None:
        parts.update(shear_stiffness=k / 3, shear_viscosity=k / 3 * eta if dashpots else None)
        wanted = {"cohesion": cohesion, "friction": draw(some(0, 2)), "residual_cohesion": cohesion}
        wanted["dynamic_friction"] = wanted["friction"] * draw(some(0, 0.9))
        wanted["weakening_distance"] = 1e-4 * draw(some(0.1, 10))
        parts.update((name, value) for name, value in wanted.items() if name[0] in shears)
        if "i" in shears:
            dilation = parts.get("dynamic_friction", wanted["friction"]) * draw(some(0, 1))
            parts.update(dilation=dilation, dilation_distance=1e-4 * draw(some(0.1, 10)))
        if "R" in shears:
            parts.update(draw(rated()))
    law = Law(k, k * eta if dashpots else None, False if "no tension" in opens else None, **parts)
    slips = (0.0, 0.0) if shears is None else (1e-4 * draw(some(-1, 1)), 1e-4 * draw(some(-1, 1)))
    history = Point(before, *slips, cohesion, 1e-4 * draw(some(0, 1)))
    return law, history, draw(st.sampled_from([0.0, 1e2, 2e5]))


@st.composite
def rated(draw):
    """Return the numbers of friction that depends on rate and state."""
    effect = 0.01 * draw(some(0.1, 10))
    return {
        "direct_effect": effect,
        "evolution_effect": effect * draw(some(0, 2)),
        "critical_slip_distance": 1e-3 * draw(some(0.1, 10)),
        "reference_rate": 1e-6,
        "initial_state": 10 ** draw(some(-4, 4)),
    }


# gap and slips after the step over 0.1 mm, their rates over 1 m/s.
states = st.tuples(some(-1, 1), some(-1, 1), some(-1, 1), some(-1, 1), some(-1, 1), some(-1, 1))


class Step:
    """The law as a function of (gap, slip_x, slip_z), whose rates follow by the rate factor."""

    def __init__(self, law, history, r, state):
        self.point, self.history, self.r = at_point(law), history, r
        self.at, self.rate = 1e-4 * np.array(state[:3]), np.array(state[3:])

    def arguments(self, at):
        gap_rate, *slip_rate = self.rate + self.r * (at - self.at)
        return *self.point, at[0], gap_rate, tuple(at[1:]), tuple(slip_rate)

    def traction(self, at):
        return np.array(self.after(at)[:3])

    def after(self, at):
        return advance(*self.arguments(at), DT, self.history)

    def tangent(self):
        """Return the tangent as a matrix [traction, displacement]."""
        nn, *shear = tangent(*self.arguments(self.at), DT, self.history, self.r)
        xn, zn, xx, xz, zz, nx, nz = shear
        return np.array([[nn, nx, nz], [xn, xx, xz], [zn, xz, zz]])

    def trial(self, at):
        """Return the trial shear traction, Pa."""
        *_, slip, rate = self.arguments(at)
        h = self.history
        return shear_traction(*self.point, h.ex + slip[0], h.ez + slip[1], *rate)

    def branch(self, at):
        """Return on which side of every kink of the law a state is."""
        law, parts, gap, gap_rate, *_ = self.arguments(at)
        if parts.dilation:
            gap = gap - lift(law, self.history.path)
        opening, left, share = max(self.history.opening, gap), np.inf, 1.0
        t_n = normal_traction(law, parts, gap, gap_rate, opening)
        if parts.softening:
            left = strength_left(law, opening)
            share = stiffness_left(law, opening) if gap > 0 else 1.0
        spring = spring_alone(law, parts, gap)
        free = share * (spring - dashpot(law, parts, spring)[0] * gap_rate)
        signs = [gap > 0, t_n > 0, t_n == 0, free < -left * (1 + EPS)]
        if parts.softening:
            first = law.tensile_strength / law.normal_stiffness
            signs += [gap > self.history.opening, opening > first, opening >= law.critical_opening]
        if parts.shear:
            h = self.history
            tau = shear_strength(law, parts, t_n, gap, opening, h.cohesion, h.path)
            signs += [tau > 0, hypot(*self.trial(at)) > tau]
            after = self.after(at)
            if parts.weakening:
                signs += [after[3].path < law.weakening_distance]
            if parts.dilation:
                signs += [after[3].path < law.dilation_distance, after[3].path > h.path]
        return signs


@pytest.mark.parametrize(("dashpots", "opens", "shears"), COMBINATIONS)
@settings(max_examples=10)
@given(data=st.data())
def test_tangent_is_the_derivative(dashpots, opens, shears, data):
    """Central differences within one branch of the law.

    Normal: the law is linear in the gap g but for s(k) / k, whose third derivative is below 6 / k^4
    of s_t w_c^2 / (w_c - w_0) <= 11 s_t w_c. Over a step of a share e of k (of |g| elsewhere)
    this truncates 11 e^2 of the tractions S that are added up, over k; round-off adds 2 eps S / h.
    Closed: over (s_m + sigma) / k the hyperbola's slope k doubles, and its third derivative is
    below 24 k (k / (s_m + sigma))^2, rock beside it or not: steps of e of that truncate 4 e^2 k.
    Shear: the direction of T* turns over |T*| / a, a = K_s + r C_s; its third derivative is below
    9 (a / |T*|)^3, so steps of e |T*| / a truncate 9 / 6 e^2 a, and round-off adds as before."""
    law, history, r = data.draw(one_law(dashpots, opens, shears))
    step = Step(law, history, r, data.draw(states))
    (gap, x, z), (gap_rate, rate_x, rate_z) = step.at, step.rate
    bend = max(abs(gap), 1e-9)
    viscosity = law.normal_viscosity or 0.0
    normal = law.normal_stiffness * abs(gap) + viscosity * abs(gap_rate)
    normal += viscosity * r * bend + (law.tensile_strength or 0.0)
    curved, law_here = 0.0, step.point[0]
    if law.maximum_closure is not None and gap < 0:
        pressed, s_m = spring_alone(*step.point, gap), closing(law_here)[1]
        steepest = closure_stiffness(law_here, pressed)
        bend = min(bend, (s_m + pressed) / steepest)
        normal += pressed + steepest * abs(gap)
        curved = 4 * SHARE**2 * steepest
    steps, sums = [SHARE * bend], [normal, 0.0, 0.0]
    if law.shear_stiffness is not None:
        drag = law.shear_viscosity or 0.0
        a = law.shear_stiffness + r * drag
        size = max(hypot(*step.trial(step.at)), 1.0)
        shear = law.shear_stiffness * (abs(history.ex) + abs(x) + abs(history.ez) + abs(z))
        shear += drag * (abs(rate_x) + abs(rate_z)) + (law.cohesion or 0.0)
        steps += [SHARE * size / a] * 2
        sums[1:] = [shear + (law.friction or 0.0) * normal] * 2
    found, sums = step.tangent(), np.array(sums)
    if law.shear_stiffness is not None and law.dilation is None:
        # A slide takes stiffness away: the critical step is that of a joint that holds.
        resists = -(found[1:, 1:] + found[1:, 1:].T) / 2
        assert np.linalg.eigvalsh(resists)[-1] <= a * (1 + 1e-9)
    for i, h in enumerate(steps):
        move = h * np.eye(3)[i]
        ends = step.at - move, step.at + move
        assume(all(step.branch(end) == step.branch(step.at) for end in ends))
        difference = (step.traction(ends[1]) - step.traction(ends[0])) / (ends[1] - ends[0])[i]
        bound = (11 * SHARE**2 * SHARE + 4 * EPS) * sums / h
        if i == 0:
            bound += curved * np.array([1, law.friction or 0.0, law.friction or 0.0])
        else:
            bound[1:] += 1.5 * SHARE**2 * a
        if law.direct_effect is not None:
            # The slide is known to 1e-12 of it; mu bends over a unit of ln V, of which a step is
            # at most e a / (direct_effect t_n), and where the joint is softer than friction falls
            # by 1 / slope of that.
            steep = np.abs(found).max() / min(law.normal_stiffness, law.shear_stiffness) + 1
            bound = bound + 1e-11 * steep * sums.sum() / h + 1e-5 * np.abs(found).max()
        if law.dilation is not None:
            # All tractions meet in each; a slide enlarges round-off as it does the tangent, and its
            # own lengths, D_w and D, are some 1e5 steps.
            lifted = law.dilation * law.dilation_distance + abs(gap)
            lifted *= law.normal_stiffness + viscosity * max(r, 1 / DT)
            steep = np.abs(found).max() / min(law.normal_stiffness, law.shear_stiffness) + 1
            bound = bound + 32 * EPS * steep * (sums.sum() + lifted) / h
            bound += 1e-6 * np.abs(found).max()
        assert (np.abs(difference - found[:, i]) <= bound).all()


SOFT = Law(1e9, tensile_strength=1e5, critical_opening=1e-3)  # w_0 = 0.1 mm
FALL = 1e5 / (1e-3 - 1e-4)


@pytest.mark.parametrize(
    ("law", "before", "gap", "left", "right"),
    [
        (Law(1e9, None, False), 0.0, 0.0, -1e9, 0.0),
        (SOFT, 0.0, 1e-4, -1e9, FALL),
        (SOFT, 4e-4, 4e-4, -FALL * 6e-4 / 4e-4, FALL),
        (SOFT, 4e-4, 0.0, -1e9, -FALL * 6e-4 / 4e-4),
        (SOFT, 5e-4, 1e-3, FALL, 0.0),
    ],
    ids=["no tension", "strength", "unloading", "contact", "broken"],
)
def test_normal_kinks_have_the_slope_of_either_side(law, before, gap, left, right):
    """Without a dashpot the law is piecewise linear: 1 nm beside a kink, and one of both at it."""
    for side, slope in ((-1e-9, left), (1e-9, right)):
        found = normal_tangent(*at_point(law), gap + side, 0.0, before, 0.0)
        assert found == pytest.approx(slope, rel=1e-5)
    at = normal_tangent(*at_point(law), gap, 0.0, before, 0.0)
    assert at == pytest.approx(right if gap == 1e-3 else left, rel=1e-12)


COULOMB = Law(9e9, None, None, 3e9, cohesion=1e5, friction=0.5)
CLOSED = -1e-4  # 0.9 MPa: a strength of 0.55 MPa
LIMIT = 5.5e5 / 3e9


def test_shear_turns_and_grows_with_the_pressure_once_it_slips():
    """At 3-4-5 on the surface: no stiffness along the slip, tau / |T*| of it across, and
    friction carries the normal stiffness over."""
    at = (1.2 * LIMIT, -1.6 * LIMIT)  # twice the limit, towards (0.6, -0.8)
    found = tangent(*at_point(COULOMB), CLOSED, 0.0, at, (0.0, 0.0), DT, Point(), 0.0)
    nn, xn, zn, *shear, _, _ = found
    n = np.array([-0.6, 0.8])
    assert nn == -9e9
    assert [xn, zn] == pytest.approx(0.5 * -9e9 * n, rel=1e-12)
    xx, xz, zz = shear
    turn = -3e9 / 2 * (np.eye(2) - np.outer(n, n))
    assert np.array([[xx, xz], [xz, zz]]) == pytest.approx(turn, rel=1e-12, abs=1e-3)
