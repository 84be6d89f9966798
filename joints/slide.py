"""The slide of a step in joints whose strength or normal traction depends on slip.

A point whose trial traction T* exceeds the strength slides by l, which unloads spring and dashpot
by a l, a = K_s + C_s / dt, until they carry the strength that is left:

    |T*| - a l = tau(t_n(l), S + l),

with t_n at the gap less the dilation w(S + l). Slip of faces without compression does not count in
the path S. Rate-dependent friction is in `joints.rate_state`.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from jointwave.joints.dilation import lift, lift_rate
from jointwave.joints.formula import formula
from jointwave.joints.normal import normal_tangent, normal_traction
from jointwave.joints.rate_state import slide_at_rate
from jointwave.joints.shear import resistance, shear_strength, shear_traction, size_of
from jointwave.joints.weakening import friction_left, strength_fall, weakened

MOST = 60  # Newton steps, safeguarded by bisection of a bracket
SETTLED = 1e-14  # convergence, over the longest possible slip


class Trial(NamedTuple):
    """The trial state of a step, and the result of its slide.

    gap : less the dilation before the step, m. opening : the largest so far, m. x, z : elastic slip
    without sliding in the step, m. still : strength before the slide, Pa. t_n, tau, path : normal
    traction and strength, Pa, and the path, m, after the slide.
    """

    gap: float
    opening: float
    x: float
    z: float
    still: float
    t_n: float
    tau: float
    path: float


@formula
def after_slide(law, parts, start, rate, cohesion, dt):
    """Return normal traction and strength (Pa) and the path (m) at the end of a step.

    start : the `Trial` without a slide. rate : of the jump, m/s. cohesion : of this point, Pa.
    """
    t_n, tau, path = start.t_n, start.tau, start.path
    t_x, t_z = shear_traction(law, parts, start.x, start.z, rate[1], rate[2])
    size, a = size_of(parts, t_x, t_z), resistance(law, parts, dt)
    pressed = t_n > 0.0 and start.gap <= 0.0
    if parts.rate_state and law.direct_effect > 0.0:
        after, state = tau, path
        if pressed:
            after, state = slide_at_rate(law, t_n, tau, path, size, a, dt)
        return t_n, after, state
    wears = pressed and size > tau
    if not parts.dilation or law.dilation == 0.0:
        after, further = tau, path
        if parts.weakening or parts.dilation:
            further = path + (size - tau) / a
        if parts.weakening:
            after, further = weakened(law, t_n, path, tau, size, a)
        return t_n, after if wears else tau, further if wears else path
    if not wears:
        return t_n, tau, path
    return lifted_slide(law, parts, start, rate[0], cohesion, size, dt)


@formula
def lifted_slide(law, parts, start, gap_rate, cohesion, size, dt):
    """Return the same as `after_slide`, for a dilatant joint; size : |T*|, Pa."""
    gap, opening, path, t_n = start.gap, start.opening, start.path, start.t_n
    a, before = resistance(law, parts, dt), lift(law, start.path)
    low, high, way = 0.0, size / a, 0.0
    for _ in range(MOST):
        up = lift(law, path + way) - before
        t_n = normal_traction(law, parts, gap - up, gap_rate - up / dt, opening)
        tau = shear_strength(law, parts, t_n, gap - up, opening, cohesion, path + way)
        left = size - a * way - tau
        if left > 0.0:
            low = way
        else:
            high = way
        slope = resistance_to_slide(
            law, parts, t_n, gap - up, gap_rate - up / dt, opening, path + way, dt
        )
        further = left / slope if slope > 0.0 else high
        if abs(further) <= SETTLED * size / a:
            break
        way = way + further if low < way + further < high else 0.5 * (low + high)
    up = lift(law, path + way) - before
    t_n = normal_traction(law, parts, gap - up, gap_rate - up / dt, opening)
    tau = size - a * way
    return t_n, tau if tau > 0.0 else 0.0, path + way


@formula
def resistance_to_slide(law, parts, t_n, gap, gap_rate, opening, path, dt):
    """Return the decrease of |T*| - strength per slip, Pa/m: a, minus the weakening, plus the
    strength added by dilation. gap : minus the dilation."""
    slope = resistance(law, parts, dt)
    if parts.weakening:
        slope = slope - strength_fall(law, t_n, path)
    if parts.dilation:
        friction, up = friction_left(law, parts, t_n, path), lift_rate(law, path)
        slope = slope + friction * up * pressing(law, parts, gap, gap_rate, opening, dt)
    return slope


@formula
def pressing(law, parts, gap, gap_rate, opening, dt):
    """Return the normal traction added per dilation in a step, Pa/m; gap : minus the dilation."""
    return -normal_tangent(law, parts, gap, gap_rate, opening, 1.0 / dt)


@cache
def trial_for(shear: bool, path: bool) -> Callable:
    """Return the formula `trial`, compiled without shear or path if joints have none."""

    @formula
    def trial(law, parts, jump, rate, dt, history):
        """Return the `Trial` of a step, for the arguments of `joints.law.traction`."""
        gap, opening, way = jump[0], history.opening, history.path
        if path and parts.dilation:
            gap = gap - lift(law, way)
        if parts.softening:
            opening = gap if gap > opening else opening
        t_n = normal_traction(law, parts, gap, rate[0], opening)
        x, z, still, tau = 0.0, 0.0, 0.0, 0.0
        if shear and parts.shear:
            x = jump[1] - history.slide_x
            if not parts.planar:
                z = jump[2] - history.slide_z
            still = shear_strength(law, parts, t_n, gap, opening, history.cohesion, way)
            tau = still
        if path and parts.path:
            start = Trial(gap, opening, x, z, still, t_n, still, way)
            t_n, tau, way = after_slide(law, parts, start, rate, history.cohesion, dt)
        return Trial(gap, opening, x, z, still, t_n, tau, way)

    return trial
