"""Normal traction of a joint: spring, dashpot, softening, no tension."""

from joints.formula import formula
from joints.softening import stiffness_left, strength_left


@formula
def normal_traction(law, parts, gap, gap_rate, opening):
    """Return t_n (Pa) of one joint: spring and dashpot, the whole cut by what it can pull.

    opening : the largest so far with this gap included, m; any number without softening.

    The total gap decides opening, equation (10); a force kept by increments would forget it.
    """
    t = -law.normal_stiffness * gap
    if parts.dashpots:
        t = t - law.normal_viscosity * gap_rate
    return _cut(law, parts, t, gap, opening)


@formula
def spring_traction(law, parts, gap, opening):
    """Return the elastic part of t_n (Pa): what is stored, not dissipated."""
    return _cut(law, parts, -law.normal_stiffness * gap, gap, opening)


@formula
def _cut(law, parts, t, gap, opening):
    if parts.softening:
        share = stiffness_left(law, opening) if gap > 0.0 else 1.0
        t, most = share * t, -strength_left(law, opening)
        t = most if t < most else t
    if parts.no_tension and not law.carries_tension:
        t = 0.0 if gap > 0.0 or t < 0.0 else t
    return t
