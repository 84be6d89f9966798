"""The consistent tangent of the joint law: how traction answers displacement within one step.

An implicit step of rate factor r has gap_rate = r gap + const and slip_rate = r slip + const
(Newmark: r = gamma / (beta dt)), so a dashpot C counts as a spring r C. With them the derivatives
of `joints.law.traction` make Newton's method quadratic (Simo & Hughes, Computational
Inelasticity, 1998, section 3.3). Shear does not act back on the normal traction: t_n depends on
the gap alone.

At a kink the tangent is that of the side whose branch the traction takes: a joint of zero gap is
closed, one at its largest opening unloads, shear on the strength has not slipped yet.
"""

from math import sqrt
from typing import NamedTuple

from joints.closure import closure_stiffness
from joints.formula import formula
from joints.normal import normal_traction, spring_alone
from joints.shear import UNLIMITED, path_after, resistance, shear_strength, shear_traction
from joints.softening import stiffness_left, strength_left
from joints.weakening import friction_left, strength_fall


class Tangent(NamedTuple):
    """Derivatives of the traction, Pa/m: nn of t_n with the gap, xn and zn of t_x and t_z with it,
    xx, xz, zz of t_x and t_z with the slips (xz = zx); the rest is zero. Without shear nn alone."""

    nn: float
    xn: float = 0.0
    zn: float = 0.0
    xx: float = 0.0
    xz: float = 0.0
    zz: float = 0.0


@formula
def tangent(law, parts, gap, gap_rate, slip, slip_rate, dt, history, r):
    """Return the `Tangent` of one point, for the arguments of `joints.law.traction`.

    gap, gap_rate : m and m/s at the end of the step; slip : its increments (dx, dz) over the
    step, m; slip_rate : (x, z), m/s; dt : s; history : before the step; r : rate factor, 1/s.
    """
    before = history.opening
    nn = normal_tangent(law, parts, gap, gap_rate, before, r)
    if not parts.shear:
        return Tangent(nn, 0.0, 0.0, 0.0, 0.0, 0.0)
    slope = -law.shear_stiffness
    if parts.dashpots:
        slope = slope - law.shear_viscosity * r
    if not parts.limited:
        return Tangent(nn, 0.0, 0.0, slope, 0.0, slope)
    opening = max(before, gap)
    t_n = normal_traction(law, parts, gap, gap_rate, opening)
    ex, ez, path = history.ex + slip[0], history.ez + slip[1], history.path
    tau = shear_strength(law, parts, t_n, gap, opening, history.cohesion, path)
    tau, path = path_after(law, parts, t_n, path, tau, ex, ez, slip_rate[0], slip_rate[1], dt)
    rise = _strength_rise(law, parts, nn, tau, gap, before, history.cohesion, t_n, path)
    t_x, t_z = shear_traction(law, parts, ex, ez, slip_rate[0], slip_rate[1])
    share = 1.0
    if parts.weakening:
        share = _share_of_trial(law, parts, t_n, path, tau, t_x, t_z, dt)
        rise = share * rise
    xn, zn, xx, xz, zz = _returned(parts, tau, rise, t_x, t_z, slope, share)
    return Tangent(nn, xn, zn, xx, xz, zz)


@formula
def _share_of_trial(law, parts, t_n, path, tau, t_x, t_z, dt):
    """Return by how much a slide exceeds, for what changes it, that of a strength that stays.

    Of tau = tau(S + l), l = (|T*| - tau) / a, with the strength's fall h at the end of the step:
    d tau = share rise d gap + (1 - share) d|T*|, share = a / (a - h).
    """
    a, slips = resistance(law, parts, dt), t_x * t_x + t_z * t_z > tau * tau
    left = a - strength_fall(law, t_n, path)
    return a / left if slips and left > 0.0 else 1.0


@formula
def normal_tangent(law, parts, gap, gap_rate, before, r):
    """Return d t_n / d gap (Pa/m) alone; before : the largest opening before this gap, m; the
    others as in `tangent`."""
    t, slope = spring_alone(law, parts, gap), -law.normal_stiffness
    if parts.closure and gap < 0.0:
        slope = -closure_stiffness(law, t)
    if parts.dashpots:
        t, slope = t - law.normal_viscosity * gap_rate, slope - law.normal_viscosity * r
    if parts.softening:
        opening = max(before, gap)
        loss = _strength_loss(law, gap, before)
        share = stiffness_left(law, opening) if gap > 0.0 else 1.0
        # Of s(k) / (K k), falling only where the strength does.
        falling = (loss / law.normal_stiffness - share) / opening if loss < 0.0 else 0.0
        # The spring alone reaches the strength left and never exceeds it, but for round-off.
        cut = parts.dashpots and share * t < -strength_left(law, opening)
        slope = -loss if cut else share * slope + falling * t
    if parts.no_tension and not law.carries_tension:
        slope = slope if gap <= 0.0 and t >= 0.0 else 0.0
    return slope


@formula
def _strength_loss(law, gap, before):
    """Return d s(k) / d gap (Pa/m), zero but where the joint opens further and softens."""
    first = law.tensile_strength / law.normal_stiffness
    softens = gap > before and first < gap < law.critical_opening
    return -law.tensile_strength / (law.critical_opening - first) if softens else 0.0


@formula
def _strength_rise(law, parts, nn, tau, gap, before, cohesion, t_n, path):
    """Return d tau / d gap (Pa/m) of the shear strength tau, zero where nothing is left of it."""
    rise = friction_left(law, parts, t_n, path) * nn
    if parts.softening:
        c = cohesion if parts.residual else law.cohesion
        rise += (
            0.0 if c >= UNLIMITED else c / law.tensile_strength * _strength_loss(law, gap, before)
        )
    return rise if 0.0 < tau < UNLIMITED else 0.0


@formula
def _returned(parts, tau, rise, t_x, t_z, slope, share):
    """Return (xn, zn, xx, xz, zz) of a trial traction of this slope with slip.

    On the strength T = tau n, n = T* / |T*|: dT = n dtau + tau / |T*| (1 - n n^T) dT*; share : of
    `_share_of_trial`.
    """
    size = sqrt(t_x * t_x + t_z * t_z)
    slips = size > tau
    n_x, n_z = t_x / size if slips else 0.0, t_z / size if slips else 0.0
    # Without any strength left the traction is zero, whether there is a trial one or not.
    left = 0.0 if tau <= 0.0 else slope
    turn = left * tau / size if slips else left
    if parts.weakening:
        along = (1.0 - share) * left
        return (
            n_x * rise,
            n_z * rise,
            turn + (along - turn) * n_x * n_x,
            (along - turn) * n_x * n_z,
            turn + (along - turn) * n_z * n_z,
        )
    return (
        n_x * rise,
        n_z * rise,
        turn * (1.0 - n_x * n_x),
        -turn * n_x * n_z,
        turn * (1.0 - n_z * n_z),
    )
