"""The consistent tangent of the joint law: how traction answers displacement within one step.

An implicit step of rate factor r has gap_rate = r gap + const and slip_rate = r slip + const
(Newmark: r = gamma / (beta dt)), so a dashpot C counts as a spring r C. With them the derivatives
of `joints.laws.traction` make Newton's method quadratic (Simo & Hughes, Computational Inelasticity,
1998, section 3.3). Shear does not act back on the normal traction: t_n depends on the gap alone.

At a kink the tangent is that of the side whose branch the traction takes: a joint of zero gap is
closed, one at its largest opening unloads, shear on the strength has not slipped yet.
"""

from math import sqrt
from typing import Any, NamedTuple

from joints.laws import normal_traction
from joints.shear import UNLIMITED, shear_strength, shear_traction
from joints.softening import stiffness_left, strength_left, update_opening
from numerics.jit import inlined, jitted


class Tangent(NamedTuple):
    """Derivatives of the traction, Pa/m: nn of t_n with the gap, xn and zn of t_x and t_z with it,
    xx, xz, zz of t_x and t_z with the slips (xz = zx); the rest is zero. Without shear nn alone."""

    nn: Any
    xn: Any = None
    zn: Any = None
    xx: Any = None
    xz: Any = None
    zz: Any = None


@jitted
def tangent(law, gap, gap_rate, slip, slip_rate, history, r):
    """Return the `Tangent` of one point, for what `joints.laws.traction` takes.

    gap, gap_rate : m and m/s at the end of the step; slip : its increments (dx, dz) over the
    step, m; slip_rate : (x, z), m/s; history : before the step; r : rate factor, 1/s.
    """
    nn = normal_tangent(law, gap, gap_rate, history.opening, r)
    xn, zn, xx, xz, zz = _shear(
        law, nn, gap, gap_rate, slip, slip_rate, history.opening, history.ex, history.ez,
        history.cohesion, r,
    )  # fmt: skip
    return Tangent(nn, xn, zn, xx, xz, zz)


@jitted
def normal_tangent(law, gap, gap_rate, before, r):
    """Return d t_n / d gap (Pa/m) alone; before : the largest opening before this gap, m, or
    None without softening; the others as in `tangent`."""
    t = _uncut(law.normal_stiffness, law.normal_viscosity, gap, gap_rate)
    slope = _uncut(law.normal_stiffness, law.normal_viscosity, 1.0, r)
    softened = _softened(slope, t, law.tensile_strength, law.normal_viscosity, law, gap, before)
    return _without_tension(softened, t, law.carries_tension, gap)


@inlined
def _uncut(stiffness, viscosity, x, rate):
    if viscosity is None:
        return -stiffness * x
    return -stiffness * x - viscosity * rate


@inlined
def _softened(slope, t, strength, viscosity, law, gap, before):
    if strength is None:
        return slope
    opening = update_opening(before, gap)
    loss = _strength_loss(strength, law, gap, before)
    share = stiffness_left(law, opening) if gap > 0.0 else 1.0
    # Of s(k) / (K k), falling only where the strength does.
    falling = (loss / law.normal_stiffness - share) / opening if loss < 0.0 else 0.0
    cut = _pulls_more(viscosity, share * t, strength_left(law, opening))
    return -loss if cut else share * slope + falling * t


@inlined
def _strength_loss(strength, law, gap, before):
    """Return d s(k) / d gap (Pa/m), zero but where the joint opens further and softens."""
    if strength is None:
        return 0.0
    first = strength / law.normal_stiffness
    softens = gap > before and first < gap < law.critical_opening
    return -strength / (law.critical_opening - first) if softens else 0.0


@inlined
def _pulls_more(viscosity, t, strength):
    # The spring alone reaches the strength left and never exceeds it, but for round-off.
    if viscosity is None:
        return False
    return t < -strength


@inlined
def _without_tension(slope, t, carries_tension, gap):
    if carries_tension is None:
        return slope
    return slope if carries_tension or (gap <= 0.0 and t >= 0.0) else 0.0


@inlined
def _shear(law, nn, gap, gap_rate, slip, slip_rate, before, ex, ez, cohesion, r):
    if ex is None:
        return None, None, None, None, None
    opening = update_opening(before, gap)
    t_n = normal_traction(law, gap, gap_rate, opening)
    tau = shear_strength(law, t_n, gap, opening, cohesion)
    rise = _strength_rise(law, nn, tau, gap, before, cohesion)
    trial = shear_traction(law, ex + slip[0], ez + slip[1], slip_rate[0], slip_rate[1])
    slope = _uncut(law.shear_stiffness, law.shear_viscosity, 1.0, r)
    return _returned(tau, rise, trial[0], trial[1], slope)


@inlined
def _strength_rise(law, nn, tau, gap, before, cohesion):
    """Return d tau / d gap (Pa/m) of the shear strength tau, zero where nothing is left of it."""
    if tau is None:
        return 0.0
    rise = _cohesion_rise(law.cohesion, cohesion, law.tensile_strength, law, gap, before)
    return rise + _friction_rise(law.friction, nn) if 0.0 < tau < UNLIMITED else 0.0


@inlined
def _cohesion_rise(own_cohesion, cohesion, strength, law, gap, before):
    if own_cohesion is None or strength is None:
        return 0.0
    c = _of_this_point(own_cohesion, cohesion)
    return 0.0 if c >= UNLIMITED else c / strength * _strength_loss(strength, law, gap, before)


@inlined
def _of_this_point(own_cohesion, cohesion):
    if cohesion is None:
        return own_cohesion
    return cohesion


@inlined
def _friction_rise(friction, nn):
    if friction is None:
        return 0.0
    return friction * nn


@inlined
def _returned(tau, rise, t_x, t_z, slope):
    """Return (xn, zn, xx, xz, zz) of a trial traction of this slope with slip.

    On the strength T = tau n, n = T* / |T*|: dT = n dtau + tau / |T*| (1 - n n^T) dT*.
    """
    if tau is None:
        return 0.0, 0.0, slope, 0.0, slope
    size = sqrt(t_x * t_x + t_z * t_z)
    slips = size > tau
    n_x, n_z = t_x / size if slips else 0.0, t_z / size if slips else 0.0
    # Without any strength left the traction is zero, whether there is a trial one or not.
    left = 0.0 if tau <= 0.0 else slope
    turn = left * tau / size if slips else left
    return (
        n_x * rise,
        n_z * rise,
        turn * (1.0 - n_x * n_x),
        -turn * n_x * n_z,
        turn * (1.0 - n_z * n_z),
    )
