"""The law in another form: each part as the papers have it, one equation after the other.

Every part of a law is a number or None. Units and signs are those of `joints.law`: Pa, m, s;
traction compression positive, gap positive when open, shear traction on the right block."""

from itertools import product
from math import exp, expm1, hypot, inf, log

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from jointwave.joints.closure import closure_stiffness, closure_traction
from jointwave.joints.law import Law, law
from jointwave.joints.shear import UNLIMITED
from tests.joints.points import DT, Point, advance, at_point, some


def twin_strength_left(law, opening):
    """Return the tension (Pa) that can still be reached: linear softening.

    Full up to w_0 = s_t / K, falling linearly to nothing at w_c: Hillerborg, Modeer & Petersson
    (1976); Camacho & Ortiz (1996)."""
    if law.tensile_strength is None:
        return inf
    first = law.tensile_strength / law.normal_stiffness
    if opening <= first:
        return law.tensile_strength
    if opening >= law.critical_opening:
        return 0.0
    return law.tensile_strength * (law.critical_opening - opening) / (law.critical_opening - first)


def twin_secant_stiffness(law, opening):
    """Return the stiffness (Pa/m) of an open joint: K, or through the origin once it softened."""
    if law.tensile_strength is None or opening <= law.tensile_strength / law.normal_stiffness:
        return law.normal_stiffness
    return twin_strength_left(law, opening) / opening


def twin_holds(law, gap, opening):
    """Return whether the faces hold each other: an open joint must be able to pull."""
    if gap <= 0:
        return True
    return law.carries_tension is not False and twin_strength_left(law, opening) > 0


def twin_closure_traction(law, closure):
    """Return sigma (Pa) where D = d + c sigma and sigma = k_ni d / (1 - d / d_m), by its root.

    Bandis, Lumsden & Barton (1983). A millionth of 1 / k_ni is in c whatever the rock."""
    own = 1 / law.normal_stiffness - (law.rock_compliance or 0.0)
    c, k = (law.rock_compliance or 0.0) + 1e-6 * own, 1 / (own * (1 - 1e-6))

    def left(sigma):
        return c * sigma + sigma / (k + sigma / law.maximum_closure) - closure

    return brentq(left, 0.0, closure / c, xtol=1e-300, rtol=4 * np.finfo(float).eps)


def twin_viscosity(law, pressed):
    """Return C (Pa s/m) under a stress (Pa), and the sum of its parts' sizes: dashpots of joint and
    rock, each deforming by its share of the compliance of small changes; never below zero."""
    if law.normal_viscosity is None or law.maximum_closure is None or pressed <= 0:
        return law.normal_viscosity or 0.0, 0.0
    of_rock = law.rock_compliance or 0.0
    rock = of_rock * (law.rock_time_constant or 0.0)
    own = 1 / law.normal_stiffness - of_rock
    k = 1 / (own * (1 - 1e-6))
    left = (1 + pressed / (k * law.maximum_closure)) ** -2
    whole = (1 / (of_rock + 1e-6 * own + left / k)) ** 2
    at_rest = law.normal_viscosity / law.normal_stiffness**2
    sizes = whole * ((at_rest + rock) * left**2 + rock)
    return max(whole * ((at_rest - rock) * left**2 + rock), 0.0), sizes


def twin_normal_traction(law, gap, gap_rate, opening=None):
    """Return t_n of a spring and a dashpot in parallel.

    An open joint that softened has its secant stiffness, and a dashpot less by the same factor.
    A joint that does not carry tension carries nothing when open, and never pulls: Guo & Li
    (2002), equation (10); any other never pulls by more than the strength it has left. One with a
    maximum closure stiffens as it closes."""
    stiffness, viscosity = law.normal_stiffness, law.normal_viscosity or 0.0
    if gap > 0:
        if not twin_holds(law, gap, opening):
            return 0.0
        stiffness = twin_secant_stiffness(law, opening)
        viscosity *= stiffness / law.normal_stiffness
    t = -stiffness * gap
    if law.maximum_closure is not None and gap < 0:
        t = twin_closure_traction(law, -gap)
        viscosity, _ = twin_viscosity(law, t)
    t -= viscosity * gap_rate
    pull = 0.0 if law.carries_tension is False else twin_strength_left(law, opening)
    return max(t, -pull)


def twin_friction(law, t_n, path):
    """Return tan(phi): pressed faces have less by as much of the difference as of the distance is
    behind them, and no less than the dynamic one. Ida (1972); Andrews (1976)."""
    friction = law.friction or 0.0
    if law.weakening_distance is None or t_n <= 0:
        return friction
    return np.interp(path, [0, law.weakening_distance], [friction, law.dynamic_friction])


def twin_shear_strength(law, t_n, gap, opening=None, cohesion=None, path=0.0):
    """Return what |T| cannot exceed: |T| <= c + t_n tan(phi), Guo & Li (2002), equation (3).

    Cohesion is lost in proportion to the tensile strength, unless it stands for no limit. A joint
    that does not hold has none; one without cohesion and friction that holds is unlimited."""
    if not twin_holds(law, gap, opening):
        return 0.0
    if law.cohesion is None and law.friction is None:
        return UNLIMITED
    c = (law.cohesion or 0.0) if law.residual_cohesion is None else cohesion
    if law.tensile_strength is not None and c < UNLIMITED:
        c *= twin_strength_left(law, opening) / law.tensile_strength
    return max(c + t_n * twin_friction(law, t_n, path), 0.0)


def twin_lift(law, path):
    """Return w (m): the area under the tangent of the dilation angle, which falls linearly."""
    if law.dilation is None:
        return 0.0
    end = min(path, law.dilation_distance)
    left = law.dilation * (1 - end / law.dilation_distance)
    return (law.dilation + left) / 2 * end


def twin_slide(law, wears, size, strength, path, dt):
    """Return the path (m) after a step of trial traction `size`, Pa: where spring and dashpot,
    unloaded by the slide, carry the strength (a function of the path) that is there."""
    if not wears or size <= strength(path):
        return path
    a = law.shear_stiffness + (law.shear_viscosity or 0.0) / dt

    def left(slide):
        return size - a * slide - strength(path + slide)

    most = size / a * (1 + 1e-15)  # beyond the root by round-off at least
    return path + brentq(left, 0.0, most, xtol=1e-300, rtol=4 * np.finfo(float).eps)


def twin_shear_traction(law, slip_x, slip_z, rate_x, rate_z):
    """Return (t_x, t_z) of a spring and a dashpot in parallel: Guo & Li (2002), equation (2)."""
    c = law.shear_viscosity or 0.0
    return -law.shear_stiffness * slip_x - c * rate_x, -law.shear_stiffness * slip_z - c * rate_z


def twin_shear_return(law, ex, ez, ex_old, ez_old, rate_x, rate_z, tau, dt):
    """Return (t_x, t_z, ex, ez, slipped) from the trial elastic slip and the strength tau.

    What exceeds the strength is scaled back along its direction. The elastic slip is then where
    spring and dashpot carry that traction: e = (e* + h e_old) / (1 + h), e* = -T / K_s and
    h = C_s / (K_s dt)."""
    t_x, t_z = twin_shear_traction(law, ex, ez, rate_x, rate_z)
    if hypot(t_x, t_z) <= tau:
        return t_x, t_z, ex, ez, False
    scale = tau / hypot(t_x, t_z)
    t_x, t_z = scale * t_x, scale * t_z
    h = (law.shear_viscosity or 0.0) / (law.shear_stiffness * dt)
    ex = (-t_x / law.shear_stiffness + h * ex_old) / (1 + h)
    ez = (-t_z / law.shear_stiffness + h * ez_old) / (1 + h)
    return t_x, t_z, ex, ez, True


def twin_rate_and_state(law, t_n, cohesion, state, size, dt):
    """Return the strength (Pa) and ln(theta / theta_0) after a step: where spring and dashpot carry
    what friction does at the rate of the slide, in the state that follows from a constant rate.

    Dieterich (1979), Ruina (1983); mu = a asinh(e^E), Rice & Ben-Zion (1996)."""
    a, b, length = law.direct_effect, law.evolution_effect, law.critical_slip_distance
    begun = law.initial_state
    theta, stiffness = begun * exp(state), law.shear_stiffness + (law.shear_viscosity or 0.0) / dt

    def aged(rate):
        if rate * dt < 1e-30 * length:
            return theta + dt
        steady = length / rate
        return theta + (theta - steady) * expm1(-rate * dt / length)

    def friction(log_rate):
        log_state = log(law.reference_rate * aged(exp(log_rate)) / length)
        e = (law.friction + b * log_state) / a + log_rate - log(2 * law.reference_rate)
        return a * np.logaddexp(e, np.logaddexp(0, 2 * e) / 2)

    load = size - cohesion
    if load <= 0:
        return cohesion, log(aged(0.0) / begun)
    most = log(load / (stiffness * dt))
    rate = brentq(
        lambda x: load - stiffness * dt * exp(x) - t_n * friction(x),
        -1e5, most + 1e-9, xtol=1e-13, rtol=4 * np.finfo(float).eps,
    )  # fmt: skip
    # A slide below e^-32 of what would unload it, and of D_c, is none; with dashpots that matters.
    least = rate - min(most, log(length / dt)) + 32
    assume(abs(least) > 1e-6)
    if least < 0:
        return inf, log(aged(0.0) / begun)
    unloaded = stiffness * dt * exp(rate)
    strength = size - unloaded if unloaded < load / 2 else cohesion + t_n * friction(rate)
    return strength, log(aged(exp(rate)) / begun)


def twin_traction(law, gap, gap_rate, slip, slip_rate, dt, history):
    """Return (t_n, t_x, t_z, history) after a step: the normal part, then shear under it.

    The first slip of a point leaves no more than the residual cohesion."""
    before = twin_lift(law, history.path)
    opening, cohesion = max(history.opening, gap - before), history.cohesion

    def normal(path):
        lift = twin_lift(law, path)
        return twin_normal_traction(law, gap - lift, gap_rate - (lift - before) / dt, opening)

    t_n = normal(history.path)
    if law.shear_stiffness is None:
        return t_n, 0.0, 0.0, history._replace(opening=opening)
    trial = history.ex + slip[0], history.ez + slip[1]

    def strength(path):
        lifted = gap - twin_lift(law, path)
        return twin_shear_strength(law, normal(path), lifted, opening, cohesion, path)

    size = hypot(*twin_shear_traction(law, *trial, *slip_rate))
    wears = (law.weakening_distance or law.dilation_distance) and t_n > 0 and gap <= before
    if law.direct_effect is None:
        path = twin_slide(law, wears, size, strength, history.path, dt)
        t_n, tau = normal(path), strength(path)
    else:
        path = history.path
        tau = twin_shear_strength(law._replace(friction=0.0), t_n, gap, opening, cohesion)
        if t_n > 0 and gap <= 0:
            tau, path = twin_rate_and_state(law, t_n, tau, path, size, dt)
    t_x, t_z, ex, ez, slipped = twin_shear_return(
        law, *trial, history.ex, history.ez, *slip_rate, tau, dt
    )
    if slipped and law.residual_cohesion is not None:
        cohesion = min(cohesion, law.residual_cohesion)
    return t_n, t_x, t_z, Point(opening, ex, ez, cohesion, path)


# What limits the shear traction, by letter: cohesion, friction, residual cohesion, dynamic friction
# with its weakening distance, dilation (i) with its distance. None: no shear.
SHEARS = (None, "", "c", "f", "cf", "cr", "cfr", "fdw", "cfrdw", "fi", "cfdwi")
OPENS = ("ties", "no tension", "softening")
CLOSES = ("closes", "closes between rock")
COMBINATIONS = [
    *product(("", "dashpots"), OPENS, SHEARS),
    *product(("", "dashpots"), CLOSES, (None, "cfr", "cfdw", "fdwi")),
    ("dashpots", "closes, no tension", "f"),
    ("dashpots", "closes, softening", "cf"),
]


@st.composite
def one_law(draw, dashpots, opens, shears):
    """Return the smallest law of one joint, as the engines build it."""

    def one(low, high):
        return np.array([draw(some(low, high))])

    stiffness, parts = one(1e8, 1e11), {}
    if "closes" in opens:
        parts["maximum_closure"] = one(1e-6, 1e-3)
        parts["rock_compliance"] = one(0, 0.99) / stiffness if "rock" in opens else None
        parts["rock_time_constant"] = one(0, 1e-4) if "rock" in opens else None
    if "softening" in opens:
        parts["tensile_strength"] = one(1e3, 1e7)
        parts["critical_opening"] = one(1.1, 100) * parts["tensile_strength"] / stiffness
    if shears is not None:
        parts["shear_stiffness"] = one(1e8, 1e11)
        wanted = {"cohesion": one(0, 1e6), "friction": one(0, 2)}
        wanted["residual_cohesion"] = wanted["cohesion"] * one(0, 1)
        wanted["dynamic_friction"] = wanted["friction"] * one(0, 1)
        wanted["weakening_distance"] = 1e-4 * one(0.01, 10)
        parts.update((name, value) for name, value in wanted.items() if name[0] in shears)
        if "i" in shears:
            least = parts.get("dynamic_friction", wanted["friction"])
            parts["dilation"], parts["dilation_distance"] = least * one(0, 1), 1e-4 * one(0.1, 10)
    eta = one(1e-9, 1e-3) if dashpots else None
    return law(stiffness, eta, np.array(["no tension" not in opens]), **parts)


STEPS = st.lists(st.tuples(*[some(-1, 1)] * 6), min_size=1, max_size=12)


@st.composite
def paths(draw, one):
    """Return steps of (gap, gap rate, slip, slip rate) that reach every branch of a law."""
    reach = 1.5 * (one.critical_opening or 1e-4)
    steps = draw(STEPS)
    return [
        (g * reach, 10 * r, (x * 1e-4, z * 1e-4), (10 * rx, 10 * rz))
        for g, r, x, z, rx, rz in steps
    ]


def virgin(one):
    """Return the history of a point that nothing has happened to."""
    return Point(0.0, 0.0, 0.0, one.cohesion or 0.0)


def scales(one, gap, rate, slip, slip_rate, h):
    """Return the sums of all magnitudes in the normal and in the shear traction, Pa."""
    cohesion = one.cohesion or 0.0
    n = one.normal_stiffness * abs(gap) + (one.normal_viscosity or 0) * abs(rate)
    n += one.tensile_strength or 0.0
    if one.maximum_closure is not None and gap < 0:  # what the last digit of the gap is worth
        law = at_point(one)[0]
        pressed = closure_traction(law, -gap)
        n += closure_stiffness(law, pressed) * abs(gap)
        n += twin_viscosity(one, pressed)[1] * abs(rate)
    if one.shear_stiffness is None:
        return n, 0.0
    s = one.shear_stiffness * (abs(h.ex) + abs(h.ez) + abs(slip[0]) + abs(slip[1]))
    s += (one.shear_viscosity or 0) * (abs(slip_rate[0]) + abs(slip_rate[1]))
    return n, s + cohesion + (one.friction or 0.0) * n


def near(found, expected, scale):
    """Hold two numbers to 1e-13 of the scale that they were computed from."""
    assert abs(found - expected) <= 1e-13 * scale


def on_the_edge(one, t_n, step, h, opening, scale):
    """Return whether the last digit decides if a step slips."""
    gap, _, slip, slip_rate = step
    trial = twin_shear_traction(one, h.ex + slip[0], h.ez + slip[1], *slip_rate)
    tau = twin_shear_strength(one, t_n, gap, opening, h.cohesion, h.path)
    return abs(hypot(*trial) - tau) <= 1e-12 * scale


def steepness(one, t_n):
    """Return by how much a step's own fall of the strength enlarges what round-off does to it."""
    a, fall, press = one.shear_stiffness + (one.shear_viscosity or 0.0) / DT, 0.0, 0.0
    if one.weakening_distance is not None:
        fall = max(t_n, 0.0) * (one.friction - one.dynamic_friction) / one.weakening_distance
    if one.dilation is not None:
        # Where both act, a joint could carry what it does at more than one path.
        press = one.dilation * (one.normal_stiffness + (one.normal_viscosity or 0.0) / DT)
        assume(one.weakening_distance is None or fall < a)
    assume(abs(a - fall) > 1e-3 * a)
    return (1 + press * (1 + one.friction) / a) * (a / abs(a - fall) + 1)


def worn(one, t_n, step, h, n, s):
    """Return the scales n and s of a joint that slip changes: its normal traction has the error of
    the lift, and all of them what the slide makes of it."""
    if one.dilation is not None:
        lift = one.dilation * one.dilation_distance
        n += (one.normal_stiffness + (one.normal_viscosity or 0.0) / DT) * (lift + abs(step[0]))
        if one.maximum_closure is not None:  # the hyperbola is as steep as where it is closed most
            law = at_point(one)[0]
            closed = closure_stiffness(law, max(t_n, 0.0))
            n += closed * (abs(step[0]) + lift)
            s *= 1 + closed * one.dilation / one.shear_stiffness
        s += one.friction * n
    steep = steepness(one, t_n)
    return n * steep + s * steep * (one.dilation or 0.0), s * steep


@pytest.mark.parametrize(("dashpots", "opens", "shears"), COMBINATIONS)
@settings(max_examples=10)
@given(data=st.data())
def test_law_equals_its_twin(dashpots, opens, shears, data):
    """Step by step over a path, each step from the same history: tractions and memory."""
    one = data.draw(one_law(dashpots, opens, shears))
    point, h = at_point(one), virgin(one)
    for step in data.draw(paths(one)):
        n, s = scales(one, *step, h)
        t_n, t_x, t_z, after = advance(*point, *step, DT, h)
        r_n, r_x, r_z, expected = twin_traction(one, *step, DT, h)
        if at_point(one)[1].path:
            assume(not on_the_edge(one, r_n, step, h, expected.opening, s))
            n, s = worn(one, r_n, step, h, n, s)
            near(after.path, expected.path, h.path + s / one.shear_stiffness)
        near(t_n, r_n, n)
        near(t_x, r_x, s)
        near(t_z, r_z, s)
        if one.tensile_strength is not None:
            near(after.opening, expected.opening, abs(step[0]) + (one.dilation_distance or 0.0))
        if one.shear_stiffness is not None:
            near(after.ex, expected.ex, s / one.shear_stiffness)
            near(after.ez, expected.ez, s / one.shear_stiffness)
            if not on_the_edge(one, r_n, step, h, expected.opening, s):
                assert after.cohesion == expected.cohesion
        h = after


@st.composite
def rated(draw, dashpots, opens, shears):
    """Return a law whose friction depends on rate and state, with one root whatever it carries."""
    one = draw(one_law(dashpots, opens, shears))
    effect, size = 10 ** draw(st.floats(-3, -1.5)), 10 ** draw(st.floats(-4, 6))
    return one._replace(
        friction=0.1 + one.friction,
        direct_effect=effect,
        evolution_effect=effect * draw(st.floats(0, 3)),
        critical_slip_distance=10 ** draw(st.floats(-5, -2)),
        reference_rate=10 ** draw(st.floats(-9, -3)),
        initial_state=size,
    )


@pytest.mark.parametrize("shears", ["f", "cfr"])
@pytest.mark.parametrize("opens", [*OPENS, *CLOSES])
@pytest.mark.parametrize("dashpots", ["", "dashpots"])
@settings(max_examples=10)
@given(data=st.data())
def test_rate_and_state_equal_their_twin(dashpots, opens, shears, data):
    """As the law does its twin, where there is one root: A D_c >= b t_n. The slide is known to
    1e-12 of it, and what is left of the trial traction by as much."""
    one = data.draw(rated(dashpots, opens, shears))
    point, h = at_point(one), virgin(one)
    for step in data.draw(paths(one)):
        n, s = scales(one, *step, h)
        t_n, t_x, t_z, after = advance(*point, *step, DT, h)
        a = one.shear_stiffness + (one.shear_viscosity or 0.0) / DT
        assume(a * one.critical_slip_distance >= 1.1 * one.evolution_effect * max(t_n, 0.0))
        r_n, r_x, r_z, expected = twin_traction(one, *step, DT, h)
        assert t_n == pytest.approx(r_n, abs=1e-12 * n)
        assert (t_x, t_z) == pytest.approx((r_x, r_z), abs=1e-11 * s)
        assert after.path == pytest.approx(expected.path, abs=1e-9)
        elastic = pytest.approx((expected.ex, expected.ez), abs=1e-11 * s / one.shear_stiffness)
        assert (after.ex, after.ez) == elastic
        h = after


@given(data=st.data())
def test_unlike_joints_behave_as_if_alone(data):
    """In an array of laws every joint carries what it carries by itself, to the last bit.

    Where a joint lacks a strength that others have, an unlimited one stands in."""
    unlike = [("ties", ""), ("no tension", "cf"), ("softening", ""), ("closes between rock", "cf")]
    unlike += [("softening", shears) for shears in ("cfr", "cfdw", "cfi")]
    alone = [data.draw(one_law("dashpots", *one)) for one in unlike]
    alone.append(data.draw(rated("dashpots", "softening", "cf")))
    without = {"friction": 0.0, "carries_tension": True, "rock_compliance": 0.0}
    without |= {"dynamic_friction": 0.0, "dilation": 0.0, "direct_effect": 0.0}
    without |= {"rock_time_constant": 0.0}
    parts = {}
    for name, values in zip(Law._fields, zip(*alone, strict=True), strict=True):
        absent = without.get(name, UNLIMITED)
        parts[name] = np.array([absent if one is None else one for one in values])
    mixed = Law(**parts)
    path = data.draw(paths(alone[-1]))
    for j, one in enumerate(alone):
        single, among = at_point(one), at_point(mixed, j)
        a, b = virgin(one), virgin(among[0])
        for step in path:
            *t_alone, a = advance(*single, *step, DT, a)
            *t_mixed, b = advance(*among, *step, DT, b)
            if single[1].dilation:  # by Newton's method: to its last step
                assert (*t_mixed, *b) == pytest.approx((*t_alone, *a), rel=1e-9, abs=1e-9)
                continue
            assert t_alone == t_mixed
            assert (a.ex, a.ez) == (b.ex, b.ez)
            assert a.path == b.path or not single[1].path
