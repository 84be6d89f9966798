"""The consistent tangent of the joint law: derivatives of traction within one step.

An implicit step of rate factor r has gap_rate = r gap + const and slip_rate = r slip + const
(Newmark: r = gamma / (beta dt)), so a dashpot C counts as a spring r C. With them the derivatives
of `joints.law.traction` make Newton's method quadratic (Simo & Hughes, Computational
Inelasticity, 1998, section 3.3). Slip changes the normal traction where it
dilates the faces; otherwise t_n depends on the gap only.

At a kink the tangent is that of the side whose branch the traction takes: a joint of zero gap is
closed, one at its largest opening unloads, shear on the strength has not slipped yet.
"""

from math import inf, sqrt
from typing import NamedTuple

from jointwave.joints.dilation import lift, lift_rate
from jointwave.joints.formula import formula
from jointwave.joints.normal import normal_tangent, normal_traction
from jointwave.joints.rate_state import resistance_to_sliding
from jointwave.joints.shear import UNLIMITED, resistance, shear_strength, shear_traction
from jointwave.joints.slide import after_slide, pressing, resistance_to_slide
from jointwave.joints.softening import strength_loss
from jointwave.joints.weakening import friction_left


class Tangent(NamedTuple):
    """Derivatives of the traction, Pa/m: nn of t_n with the gap, xn and zn of t_x and t_z with it,
    xx, xz, zz of t_x and t_z with the slips (xz = zx), nx and nz of t_n with them. Without shear nn
    only."""

    nn: float
    xn: float = 0.0
    zn: float = 0.0
    xx: float = 0.0
    xz: float = 0.0
    zz: float = 0.0
    nx: float = 0.0
    nz: float = 0.0


@formula
def tangent(law, parts, gap, gap_rate, slip, slip_rate, dt, history, r):
    """Return the `Tangent` of one point, for the arguments of `joints.law.traction`.

    gap, gap_rate : m and m/s at the end of the step; slip : its increments (dx, dz) over the
    step, m; slip_rate : (x, z), m/s; dt : s; history : before the step; r : rate factor, 1/s.
    """
    before, path = history.opening, history.path
    if parts.dilation:
        gap = gap - lift(law, path)
    nn = normal_tangent(law, parts, gap, gap_rate, before, r)
    if not parts.shear:
        return Tangent(nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    slope = -law.shear_stiffness
    if parts.dashpots:
        slope = slope - law.shear_viscosity * r
    if not parts.limited:
        return Tangent(nn, 0.0, 0.0, slope, 0.0, slope, 0.0, 0.0)
    opening = gap if gap > before else before
    t_n = normal_traction(law, parts, gap, gap_rate, opening)
    ex, ez = history.ex + slip[0], history.ez + slip[1]
    tau = still = shear_strength(law, parts, t_n, gap, opening, history.cohesion, path)
    t_n, tau, path = after_slide(
        law, parts, t_n, tau, gap, gap_rate, opening, history.cohesion, path,
        ex, ez, slip_rate[0], slip_rate[1], dt,
    )  # fmt: skip
    t_x, t_z = shear_traction(law, parts, ex, ez, slip_rate[0], slip_rate[1])
    share, up, pressed = 1.0, 0.0, 0.0
    if parts.dilation:
        up = lift(law, path) - lift(law, history.path)
        gap, gap_rate = gap - up, gap_rate - up / dt
        nn = normal_tangent(law, parts, gap, gap_rate, before, r)
    friction = friction_left(law, parts, t_n, path)
    rated = parts.rate_state and law.direct_effect > 0.0
    if rated:
        friction = (tau - still) / t_n if t_n > 0.0 else 0.0
    rise = _strength_rise(law, parts, friction * nn, tau, gap, before, history.cohesion)
    if rated:
        a, size = resistance(law, parts, dt), sqrt(t_x * t_x + t_z * t_z)
        if friction > 0.0:
            way = (size - tau) / a
            b = a + resistance_to_sliding(law, t_n, history.path, way, dt) if way > 0.0 else inf
            share = a / b if b > 0.0 else 1.0
            rise = share * rise
    elif parts.path and path > history.path:
        # dl = (d|T*| - rise d gap) / b; d tau = d|T*| - a dl, d t_n = nn d gap + p w' dl.
        b = resistance_to_slide(law, parts, t_n, gap, gap_rate, opening, path, dt)
        share = resistance(law, parts, dt) / b if b > 0.0 else 1.0
        if parts.dilation and b > 0.0:
            press = pressing(law, parts, gap, gap_rate, opening, dt)
            pressed = press * lift_rate(law, path) / b
            nn = nn - pressed * rise
        rise = share * rise
    xn, zn, xx, xz, zz, nx, nz = _returned(parts, tau, rise, t_x, t_z, slope, share, pressed)
    return Tangent(nn, xn, zn, xx, xz, zz, nx, nz)


@formula
def _strength_rise(law, parts, rise, tau, gap, before, cohesion):
    """Return d tau / d gap (Pa/m) of the shear strength tau, zero where it is lost.

    rise : that of friction, Pa/m.
    """
    if parts.softening:
        c = cohesion if parts.residual else law.cohesion
        rise += (
            0.0 if c >= UNLIMITED else c / law.tensile_strength * strength_loss(law, gap, before)
        )
    return rise if 0.0 < tau < UNLIMITED else 0.0


@formula
def _returned(parts, tau, rise, t_x, t_z, slope, share, pressed):
    """Return (xn, zn, xx, xz, zz, nx, nz) of a trial traction of this slope with slip.

    On the strength T = tau n, n = T* / |T*|: dT = n dtau + tau / |T*| (1 - n n^T) dT*. Where slip
    changes the joint d tau is rise d gap + (1 - share) d|T*|, and d t_n has pressed d|T*|.
    """
    size = sqrt(t_x * t_x + t_z * t_z)
    slips = size > tau
    n_x, n_z = t_x / size if slips else 0.0, t_z / size if slips else 0.0
    # Without strength the traction is zero, whatever the trial traction.
    left = 0.0 if tau <= 0.0 else slope
    turn = left * tau / size if slips else left
    if parts.path:
        along = (1.0 - share) * left
        return (
            n_x * rise,
            n_z * rise,
            turn + (along - turn) * n_x * n_x,
            (along - turn) * n_x * n_z,
            turn + (along - turn) * n_z * n_z,
            pressed * slope * n_x,
            pressed * slope * n_z,
        )
    return (
        n_x * rise,
        n_z * rise,
        turn * (1.0 - n_x * n_x),
        -turn * n_x * n_z,
        turn * (1.0 - n_z * n_z),
        0.0,
        0.0,
    )
