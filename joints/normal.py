"""Normal traction of a joint: spring, dashpot, softening, no tension."""

from jointwave.joints.closure import (
    closure_stiffness,
    closure_traction,
    closure_under,
    closure_viscosity,
)
from jointwave.joints.formula import formula
from jointwave.joints.shear import UNLIMITED
from jointwave.joints.softening import stiffness_left, strength_left, strength_loss


@formula
def normal_traction(law, parts, gap, gap_rate, opening):
    """Return t_n (Pa) of one joint: spring and dashpot, limited by its tensile strength.

    opening : the largest so far with this gap included, m; any number without softening.

    t_n follows from the total gap, equation (10): increments of force would lose the opening.
    """
    t = spring_alone(law, parts, gap)
    if parts.dashpots:
        t = t - dashpot(law, parts, t)[0] * gap_rate
    return _cut(law, parts, t, gap, opening)


@formula
def spring_traction(law, parts, gap, opening):
    """Return the elastic, stored part of t_n (Pa)."""
    return _cut(law, parts, spring_alone(law, parts, gap), gap, opening)


@formula
def spring_alone(law, parts, gap):
    """Return the traction (Pa) of the spring without a tensile limit."""
    t = -law.normal_stiffness * gap
    if parts.closure:
        closed = closure_traction(law, -gap if gap < 0.0 else 0.0)
        t = closed if gap < 0.0 and law.maximum_closure < UNLIMITED else t
    return t


@formula
def dashpot(law, parts, spring):
    """Return the viscosity (Pa s/m) where the spring alone carries `spring` (Pa), and its rise with
    that (s/m)."""
    viscosity, rise = law.normal_viscosity, 0.0
    if parts.closure:
        found = closure_viscosity(law, spring if spring > 0.0 else 0.0)
        stiffens = spring > 0.0 and law.maximum_closure < UNLIMITED
        viscosity, rise = found[0] if stiffens else viscosity, found[1] if stiffens else rise
    return viscosity, rise


@formula
def gap_under(law, parts, traction):
    """Return the gap (m) at which the spring alone carries a traction (Pa), numbers or arrays."""
    if parts.closure:
        pressed = 0.5 * (traction + abs(traction))
        return (pressed - traction) / law.normal_stiffness - closure_under(law, pressed)
    return -traction / law.normal_stiffness


@formula
def _cut(law, parts, t, gap, opening):
    if parts.softening:
        share = stiffness_left(law, opening) if gap > 0.0 else 1.0
        t, most = share * t, -strength_left(law, opening)
        t = most if t < most else t
    if parts.no_tension and not law.carries_tension:
        t = 0.0 if gap > 0.0 or t < 0.0 else t
    return t


@formula
def normal_tangent(law, parts, gap, gap_rate, before, r):
    """Return d t_n / d gap (Pa/m); before : the largest opening before, m; r : rate factor, 1/s."""
    t, slope = spring_alone(law, parts, gap), -law.normal_stiffness
    if parts.closure and gap < 0.0:
        slope = -closure_stiffness(law, t)
    if parts.dashpots:
        viscosity, rise = dashpot(law, parts, t)
        t, slope = t - viscosity * gap_rate, slope * (1.0 - rise * gap_rate) - viscosity * r
    if parts.softening:
        opening = gap if gap > before else before
        loss = strength_loss(law, gap, before)
        share = stiffness_left(law, opening) if gap > 0.0 else 1.0
        # Derivative of s(k) / (K k), where the strength falls.
        falling = (loss / law.normal_stiffness - share) / opening if loss < 0.0 else 0.0
        # Without dashpots the spring exceeds the remaining strength by round-off only.
        cut = parts.dashpots and share * t < -strength_left(law, opening)
        slope = -loss if cut else share * slope + falling * t
    if parts.no_tension and not law.carries_tension:
        slope = slope if gap <= 0.0 and t >= 0.0 else 0.0
    return slope
