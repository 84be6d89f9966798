"""Normal traction of a joint: spring, dashpot, softening, no tension."""

from joints.softening import stiffness_left, strength_left
from numerics.jit import inlined, jitted


@jitted
def normal_traction(law, gap, gap_rate, opening=None):
    """Return t_n (Pa) of one joint: spring and dashpot, the whole cut by what it can pull.

    opening : the largest so far with this gap included, m; None without softening.

    The total gap decides opening, equation (10); a force kept by increments would forget it.
    """
    t = _with_dashpot(-law.normal_stiffness * gap, law.normal_viscosity, gap_rate)
    return _cut(law, t, gap, opening)


@jitted
def spring_traction(law, gap, opening=None):
    """Return the elastic part of t_n (Pa): what is stored, not dissipated."""
    return _cut(law, -law.normal_stiffness * gap, gap, opening)


@inlined
def _cut(law, t, gap, opening):
    softened = _softened(t, law.tensile_strength, law, gap, opening)
    return _without_tension(softened, law.carries_tension, gap)


@inlined
def _with_dashpot(t, viscosity, gap_rate):
    if viscosity is None:
        return t
    return t - viscosity * gap_rate


@inlined
def _softened(t, strength, law, gap, opening):
    if strength is None:
        return t
    share = stiffness_left(law, opening) if gap > 0.0 else 1.0
    return max(share * t, -strength_left(law, opening))


@inlined
def _without_tension(t, carries_tension, gap):
    if carries_tension is None:
        return t
    if carries_tension:
        return t
    return max(t, 0.0) if gap <= 0.0 else 0.0
