"""Tensile softening of a joint: linear, with secant unloading.

A joint carries tension up to its strength s_t, reached at the opening w_0 = s_t / K. Beyond, the
remaining strength falls linearly with the largest opening k, to zero at w_c = 2 G_c / s_t:

    s(k) = s_t for k <= w_0,   s_t (w_c - k) / (w_c - w_0) up to w_c,   0 beyond.

Below k the joint unloads and reloads through the origin with the secant stiffness s(k) / k.
Hillerborg, Modeer & Petersson (1976); Camacho & Ortiz (1996).
"""

from jointwave.joints.formula import formula


@formula
def strength_left(law, opening):
    """Return s(k) (Pa), the remaining strength of a joint opened by k (m)."""
    first = law.tensile_strength / law.normal_stiffness
    slope = law.tensile_strength / (law.critical_opening - first)
    falling = slope * (law.critical_opening - opening)
    falling = 0.0 if falling < 0.0 else falling
    return law.tensile_strength if opening <= first else falling


@formula
def stiffness_left(law, opening):
    """Return the secant stiffness over K: 1 before the strength is reached, 0 when broken."""
    first = law.tensile_strength / law.normal_stiffness
    beyond = first if opening <= first else opening
    secant = strength_left(law, opening) / (law.normal_stiffness * beyond)
    return 1.0 if opening <= first else secant


@formula
def is_broken(law, parts, opening):
    """Return whether a joint has lost its tensile strength; never without softening."""
    return parts.softening and strength_left(law, opening) == 0.0


@formula
def strength_loss(law, gap, before):
    """Return d s(k) / d gap (Pa/m): zero except where the joint opens further and softens."""
    first = law.tensile_strength / law.normal_stiffness
    softens = gap > before and first < gap < law.critical_opening
    return -law.tensile_strength / (law.critical_opening - first) if softens else 0.0
