"""The consistent tangent of the joint law: derivatives of traction within one step.

In an implicit step of rate factor r, gap_rate = r gap + const and slip_rate = r slip + const
(Newmark: r = gamma / (beta dt)), so a dashpot C acts as a spring r C. With these derivatives of
`joints.law.traction` Newton's method converges quadratically (Simo & Hughes, Computational
Inelasticity, 1998, section 3.3). Without dilation t_n depends on the gap only.

At a kink the tangent is that of the branch of the traction: a joint of zero gap is closed, one at
its largest opening unloads, and shear equal to the strength has not slipped yet.
"""

from collections.abc import Callable
from functools import cache
from math import inf
from typing import NamedTuple

from jointwave.joints.dilation import lift, lift_rate
from jointwave.joints.formula import formula
from jointwave.joints.normal import normal_tangent
from jointwave.joints.rate_state import resistance_to_sliding
from jointwave.joints.shear import UNLIMITED, resistance, shear_traction, size_of
from jointwave.joints.slide import pressing, resistance_to_slide, trial_for
from jointwave.joints.softening import strength_loss
from jointwave.joints.weakening import friction_left


class Tangent(NamedTuple):
    """Derivatives of the traction, Pa/m: ab is d t_a / d jump_b, xz = zx; only nn without shear."""

    nn: float
    xn: float = 0.0
    zn: float = 0.0
    xx: float = 0.0
    xz: float = 0.0
    zz: float = 0.0
    nx: float = 0.0
    nz: float = 0.0


@cache
def tangent_for(shear: bool, path: bool) -> Callable:
    """Return the formula `tangent`, compiled without shear or path if joints have none."""
    trial = trial_for(shear, path)

    @formula
    def tangent(law, parts, jump, rate, dt, history, r):
        """Return the `Tangent` of one point; r : rate factor, 1/s; others as in `law.traction`."""
        gap, opening, x, z, still, t_n, tau, way = trial(law, parts, jump, rate, dt, history)
        before, gap_rate = history.opening, rate[0]
        nn = normal_tangent(law, parts, gap, gap_rate, before, r)
        if not shear or not parts.shear:
            return Tangent(nn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        slope = -law.shear_stiffness
        if parts.dashpots:
            slope = slope - law.shear_viscosity * r
        if not parts.limited:
            return Tangent(nn, 0.0, 0.0, slope, 0.0, slope, 0.0, 0.0)
        t_x, t_z = shear_traction(law, parts, x, z, rate[1], rate[2])
        size, a = size_of(parts, t_x, t_z), resistance(law, parts, dt)
        share, pressed = 1.0, 0.0
        if path and parts.dilation:
            up = lift(law, way) - lift(law, history.path)
            gap, gap_rate = gap - up, gap_rate - up / dt
            nn = normal_tangent(law, parts, gap, gap_rate, before, r)
        friction = friction_left(law, parts, t_n, way)
        rated = path and parts.rate_state and law.direct_effect > 0.0
        if rated:
            friction = (tau - still) / t_n if t_n > 0.0 else 0.0
        rise = _strength_rise(law, parts, friction * nn, tau, gap, before, history.cohesion)
        if path and rated:
            if friction > 0.0:
                slid = (size - tau) / a
                b = a
                b += resistance_to_sliding(law, t_n, history.path, slid, dt) if slid > 0.0 else inf
                share = a / b if b > 0.0 else 1.0
                rise = share * rise
        elif path and parts.path and way > history.path:
            # dl = (d|T*| - rise d gap) / b; d tau = d|T*| - a dl, d t_n = nn d gap + p w' dl.
            b = resistance_to_slide(law, parts, t_n, gap, gap_rate, opening, way, dt)
            share = a / b if b > 0.0 else 1.0
            if parts.dilation and b > 0.0:
                press = pressing(law, parts, gap, gap_rate, opening, dt)
                pressed = press * lift_rate(law, way) / b
                nn = nn - pressed * rise
            rise = share * rise
        slips = size > tau
        n_x, n_z = t_x / size if slips else 0.0, 0.0
        if not parts.planar:
            n_z = t_z / size if slips else 0.0
        # At the strength T = tau n, n = T* / |T*|: dT = n dtau + tau / |T*| (1 - n n^T) dT*. Where
        # slip changes the joint, d tau = rise d gap + (1 - share) d|T*|, and d t_n has the term
        # pressed d|T*|. Without strength the traction is zero for any trial traction.
        left = 0.0 if tau <= 0.0 else slope
        turn = left * tau / size if slips else left
        along = (1.0 - share) * left - turn
        return Tangent(
            nn,
            n_x * rise,
            n_z * rise,
            turn + along * n_x * n_x,
            along * n_x * n_z,
            turn + along * n_z * n_z,
            pressed * slope * n_x,
            pressed * slope * n_z,
        )

    return tangent


tangent = tangent_for(shear=True, path=True)


@formula
def _strength_rise(law, parts, rise, tau, gap, before, cohesion):
    """Return d tau / d gap (Pa/m), zero without strength; rise : the part of friction, Pa/m."""
    if parts.softening:
        c = cohesion if parts.residual else law.cohesion
        rise += (
            0.0 if c >= UNLIMITED else c / law.tensile_strength * strength_loss(law, gap, before)
        )
    return rise if 0.0 < tau < UNLIMITED else 0.0
