"""Friction that depends on the rate and the state of slip: the ageing law.

Friction of faces under t_n at the slip rate V and the state theta (s, the age of contacts):

    mu = a asinh( V / (2 V_0) exp((mu_0 + b ln(V_0 theta / D_c)) / a) ),
    d theta / dt = 1 - V theta / D_c

(Dieterich, J. Geophys. Res. 84, 1979; Ruina, J. Geophys. Res. 88, 1983; regularised at V = 0 as in
Rice & Ben-Zion, PNAS 93, 1996, and Lapusta et al., J. Geophys. Res. 105, 2000). If mu is a few
times a or more, it is mu_0 + a ln(V / V_0) + b ln(V_0 theta / D_c). In steady slip theta is
D_c / V, and mu falls with V if a < b.

The history of a point is s = ln(theta / theta_0). A step of dt whose trial traction T* exceeds the
cohesion c slides by l, at V = l / dt. The exact state for this V is, with x = l / D_c,

    theta e^-x + dt (1 - e^-x) / x,

and with A = K_s + C_s / dt the slide l follows from

    |T*| - A l = c + t_n mu(l / dt, theta(l)).

As a function of ln V, the left side less the right falls at the rate
A l + t_n tanh(mu / a) (a + b d ln theta / d ln V), whose last factor is at least a - b x. So there
is one root if A D_c >= b t_n, else as long as a step slides by less than D_c a / b.
"""

from math import asinh, exp, expm1, log, log1p, sqrt

from jointwave.joints.formula import formula

MOST = 80  # Newton steps, safeguarded by bisection of a bracket
SETTLED, ROUND_OFF = 1e-12, 1e-15  # convergence: change of ln V, and residual over the load
STILL = 32.0  # a slide below e^-STILL of the longest possible one counts as zero
HELD = 1.0 + 1e-12  # strength over traction of a joint that does not slide
LN_2 = log(2.0)
LARGE = 19.0  # x from which asinh(e^x) = x + ln 2 to the last digit
SMALL = 1e-5  # x below which a difference is a series, to avoid cancellation
LEAST = 1e-300


@formula
def exponent(law, state):
    """Return (mu_0 + b ln(V_0 theta / D_c)) / a - ln(2 V_0) at s = `state`."""
    rate = law.reference_rate
    begun = log(rate * law.initial_state / law.critical_slip_distance)
    whole = law.friction + law.evolution_effect * (begun + state)
    return whole / law.direct_effect - log(2.0 * rate)


@formula
def friction_at(law, x):
    """Return mu = a asinh(e^x), x = ln V and the exponent."""
    return law.direct_effect * (x + LN_2 if x > LARGE else asinh(exp(x)))


@formula
def rate_under(law, friction, state):
    """Return ln V (V in m/s) at which mu is `friction` > 0."""
    x = friction / law.direct_effect  # ln sinh(x), for any x
    return x + log(-0.5 * expm1(-2.0 * x)) - exponent(law, state)


@formula
def ageing(x, young):
    """Return the increment of s, and d ln theta / d ln V at the end, in a step with slip x D_c;
    young : dt over the initial theta."""
    left, mean = exp(-x), -expm1(-x) / x if x > LEAST else 1.0
    turn = (left - mean) / x if x > SMALL else x / 3.0 - 0.5
    grown = log(left + young * mean) if x > 0.5 else log1p(young * mean + expm1(-x))
    return grown, x * (young * turn - left) / (left + young * mean)


@formula
def resistance_to_rate(law, t_n, x, turn):
    """Return t_n d mu / d ln V (Pa) with mu = a asinh(e^x); turn : d ln theta / d ln V."""
    sine = exp(x if x < LARGE else LARGE)
    share = sine / sqrt(1.0 + sine * sine)
    return t_n * share * (law.direct_effect + law.evolution_effect * turn)


@formula
def resistance_to_sliding(law, t_n, state, slide, dt):
    """Return d(t_n mu) / d l (Pa/m) in a step that slides by l > 0 (m); state : s before it."""
    grown, turn = ageing(slide / law.critical_slip_distance, dt / (law.initial_state * exp(state)))
    x = log(slide / dt) + exponent(law, state + grown)
    return resistance_to_rate(law, t_n, x, turn) / slide


@formula
def slide_at_rate(law, t_n, cohesion, state, size, stiffness, dt):
    """Return the strength (Pa) and s at the end of a step under t_n > 0 (Pa).

    cohesion : Pa. state : s before the step. size, stiffness : |T*|, Pa, and A, Pa/m. dt : s.
    """
    young = dt / (law.initial_state * exp(state))
    load, healed = size - cohesion, state + log1p(young)
    friction = load / t_n
    if friction <= LEAST:
        return cohesion, healed
    fastest, least = log(load / (stiffness * dt)), law.critical_slip_distance
    rate, once = rate_under(law, friction, state), log(least / dt)
    if rate < (fastest if fastest < once else once) - STILL:
        return HELD * size, healed
    # Lower bound: either the spring or the strongest friction takes at least half of the load.
    low, high = rate_under(law, 0.5 * friction, healed), fastest
    low = low if low < fastest - LN_2 else fastest - LN_2
    rate = rate if rate < high else high
    ratio, begun = law.evolution_effect / law.direct_effect, exponent(law, state)
    slide, carried, grown = 0.0, 0.0, 0.0
    for _ in range(MOST):
        slide = dt * exp(rate)
        grown, turn = ageing(slide / least, young)
        x = rate + begun + ratio * grown
        carried = t_n * friction_at(law, x)
        left = load - stiffness * slide - carried
        if left > 0.0:
            low = rate
        else:
            high = rate
        slope = stiffness * slide + resistance_to_rate(law, t_n, x, turn)
        further = left / slope if slope > 0.0 else high - low
        if abs(further) <= SETTLED or abs(left) <= ROUND_OFF * load:
            break
        rate = rate + further if low < rate + further < high else 0.5 * (low + high)
    # Add or subtract the smaller term, for less cancellation.
    unloaded = stiffness * slide
    return size - unloaded if unloaded < carried else cohesion + carried, state + grown
