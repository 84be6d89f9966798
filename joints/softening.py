"""Tensile strength that is spent by opening: linear softening, secant unloading.

A joint carries tension up to its strength s_t, reached at the opening w_0 = s_t / K. From there
the strength left falls linearly with the largest opening k so far, to nothing at w_c = 2 G_c / s_t:

    s(k) = s_t for k <= w_0,   s_t (w_c - k) / (w_c - w_0) up to w_c,   0 beyond.

Below k it unloads and reloads through the origin with the secant stiffness s(k) / k.
Hillerborg, Modeer & Petersson (1976); Camacho & Ortiz (1996).
"""

from numerics.jit import inlined, jitted


@jitted
def update_opening(opening, gap):
    """Return the largest opening (m) so far; None without softening."""
    if opening is None:
        return None
    return max(opening, gap)


@jitted
def strength_left(law, opening):
    """Return s(k) (Pa), the tension that a joint opened by k (m) can carry again."""
    first = law.tensile_strength / law.normal_stiffness
    slope = law.tensile_strength / (law.critical_opening - first)
    falling = max(slope * (law.critical_opening - opening), 0.0)
    return law.tensile_strength if opening <= first else falling


@inlined
def stiffness_left(law, opening):
    """Return the secant stiffness over K: 1 before the strength is reached, 0 when broken."""
    first = law.tensile_strength / law.normal_stiffness
    secant = strength_left(law, opening) / (law.normal_stiffness * opening)
    return 1.0 if opening <= first else secant


@jitted
def is_broken(law, opening=None):
    """Return whether a joint has no tensile strength left; never without softening."""
    return _is_broken(law.tensile_strength, law, opening)


@inlined
def _is_broken(strength, law, opening):
    if strength is None:
        return False
    return strength_left(law, opening) == 0.0
