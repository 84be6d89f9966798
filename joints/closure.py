"""Hyperbolic elastic closure of a joint, up to a maximum closure.

A joint of initial stiffness k_ni and maximum closure d_m that closes by d carries

    sigma = k_ni d / (1 - d / d_m),   d sigma / dd = k_ni (1 + sigma / s_m)^2,   s_m = k_ni d_m

(Bandis, Lumsden & Barton, Int. J. Rock Mech. Min. Sci. 20, 1983; Barton, Bandis & Bakhtar, 22,
1985). It unloads along the same curve, and opens with k_ni.

Between rigid blocks the compliance c of the rock is in series with the joint: D = d + c sigma, so

    c sigma^2 + (c s_m + d_m - D) sigma - s_m D = 0,

and the only root with the sign of D is the traction. Between deformable rock c is small
(`cases.material.closure.closed_compliance`), which limits the stiffness near d_m.
If the rock already includes the joint's compliance, c is negative, and the smaller root is the
traction up to the stress at which d sigma / dD is infinite.

The joint's dashpot is k_ni eta whatever its closure, the rock's is eta_r / c. In slow motion each
deforms by its share of the compliance, k_ni (1 + sigma / s_m)^2 = k_t and 1 / K_t = 1 / k_t + c:

    C = K_t^2 (k_ni eta / k_t^2 + c eta_r).
"""

from math import log1p, sqrt

from jointwave.joints.formula import formula

FACES = 1e-6  # compliance of a closed joint, over its initial one
SMALL = 1e-3  # traction over s_m below which the energy is a series, to avoid cancellation


@formula
def closing(law):
    """Return c, m/Pa, and s_m, Pa."""
    own = 1.0 / law.normal_stiffness - law.rock_compliance
    return law.rock_compliance + FACES * own, law.maximum_closure / ((1.0 - FACES) * own)


@formula
def closure_traction(law, closure):
    """Return sigma (Pa) at a closure D >= 0 (m)."""
    c, s_m = closing(law)
    b = c * s_m + law.maximum_closure - closure
    root = sqrt(b * b + 4.0 * c * s_m * closure)
    return 2.0 * s_m * closure / (b + root) if b > 0.0 else (root - b) / (2.0 * c)


@formula
def closure_under(law, traction):
    """Return D (m) at sigma >= 0 (Pa)."""
    c, s_m = closing(law)
    return c * traction + law.maximum_closure * traction / (s_m + traction)


@formula
def closure_stiffness(law, traction):
    """Return d sigma / dD (Pa/m) at sigma >= 0 (Pa)."""
    c, s_m = closing(law)
    share = s_m / (s_m + traction)
    return 1.0 / (c + law.maximum_closure / s_m * share * share)


@formula
def closure_viscosity(law, traction):
    """Return C (Pa s/m) at sigma >= 0 (Pa), not below zero where the rock includes more, and
    dC / d sigma (s/m)."""
    (c, s_m), stiffness = closing(law), closure_stiffness(law, traction)
    rock, share = law.rock_compliance * law.rock_time_constant, s_m / (s_m + traction)
    joint = (law.normal_viscosity / law.normal_stiffness**2 - rock) * share**4
    whole = 0.5 * (joint + rock + abs(joint + rock))
    rise = 4.0 * (rock - c * stiffness * whole) / (s_m + traction) * (whole > 0.0)
    return stiffness * stiffness * whole, stiffness * stiffness * rise


@formula
def closure_energy(law, traction):
    """Return the stored energy at sigma >= 0 (Pa), J/m2: c sigma^2 / 2 + s_m d_m (ln(1 + x) - x /
    (1 + x)), x = sigma / s_m."""
    c, s_m = closing(law)
    x = traction / s_m
    if x < SMALL:
        whole = x * x * (1 / 2 - x * (2 / 3 - x * (3 / 4 - x * (4 / 5 - x * 5 / 6))))
    else:
        whole = log1p(x) - x / (1.0 + x)
    return 0.5 * c * traction * traction + s_m * law.maximum_closure * whole
