"""The joint laws again, in plain Python: what the other modules compile must equal this.

Every part of a law is a number or None. Units and signs are those of `joints.laws`: Pa, m, s;
traction compression positive, gap positive when open, shear traction on the right block.
"""

from math import hypot, inf
from typing import Any

from joints.laws import History, Law
from joints.shear import UNLIMITED


def update_opening(opening: float | None, gap: float) -> float | None:
    """Return the largest opening so far, m."""
    return None if opening is None else max(opening, gap)


def strength_left(law: Law, opening: Any) -> float:
    """Return the tension (Pa) that can still be reached: linear softening.

    Full up to w_0 = s_t / K, falling linearly to nothing at w_c: Hillerborg, Modeer & Petersson
    (1976); Camacho & Ortiz (1996).
    """
    if law.tensile_strength is None:
        return inf
    first = law.tensile_strength / law.normal_stiffness
    if opening <= first:
        return law.tensile_strength
    if opening >= law.critical_opening:
        return 0.0
    return law.tensile_strength * (law.critical_opening - opening) / (law.critical_opening - first)


def secant_stiffness(law: Law, opening: Any) -> float:
    """Return the stiffness (Pa/m) of an open joint: K, or through the origin once it softened."""
    if law.tensile_strength is None or opening <= law.tensile_strength / law.normal_stiffness:
        return law.normal_stiffness
    return strength_left(law, opening) / opening


def is_broken(law: Law, opening: float | None) -> bool:
    """Return whether no tensile strength is left."""
    return strength_left(law, opening) == 0


def holds(law: Law, gap: float, opening: float | None) -> bool:
    """Return whether the faces hold each other: an open joint must be able to pull."""
    if gap <= 0:
        return True
    return law.carries_tension is not False and not is_broken(law, opening)


def normal_traction(law: Law, gap: float, gap_rate: float, opening: float | None = None) -> float:
    """Return t_n of a spring and a dashpot in parallel.

    An open joint that softened has its secant stiffness, and a dashpot less by the same factor.
    A joint that does not carry tension carries nothing when open, and never pulls: Guo & Li
    (2002), equation (10); any other never pulls by more than the strength it has left.
    """
    stiffness, viscosity = law.normal_stiffness, law.normal_viscosity or 0.0
    if gap > 0:
        if not holds(law, gap, opening):
            return 0.0
        stiffness = secant_stiffness(law, opening)
        viscosity *= stiffness / law.normal_stiffness
    t = -stiffness * gap - viscosity * gap_rate
    pull = 0.0 if law.carries_tension is False else strength_left(law, opening)
    return max(t, -pull)


def spring_traction(law: Law, gap: float, opening: float | None = None) -> float:
    """Return the elastic part of t_n: the same without its dashpot."""
    return normal_traction(law._replace(normal_viscosity=None), gap, 0.0, opening)


def shear_strength(
    law: Law, t_n: float, gap: float, opening: float | None = None, cohesion: float | None = None
) -> float:
    """Return what |T| cannot exceed: |T| <= c + t_n tan(phi), Guo & Li (2002), equation (3).

    Cohesion is lost in proportion to the tensile strength, unless it stands for no limit. A joint
    that does not hold has none; one without cohesion and friction that holds is unlimited.
    """
    if not holds(law, gap, opening):
        return 0.0
    if law.cohesion is None and law.friction is None:
        return UNLIMITED
    c = law.cohesion or 0.0
    if cohesion is not None and law.cohesion is not None:
        c = cohesion
    if law.tensile_strength is not None and c < UNLIMITED:
        c *= strength_left(law, opening) / law.tensile_strength
    return max(c + t_n * (law.friction or 0.0), 0.0)


def shear_traction(
    law: Law, slip_x: float, slip_z: float, rate_x: float, rate_z: float
) -> tuple[float, float]:
    """Return (t_x, t_z) of a spring and a dashpot in parallel: Guo & Li (2002), equation (2)."""
    c = law.shear_viscosity or 0.0
    return (
        -law.shear_stiffness * slip_x - c * rate_x,
        -law.shear_stiffness * slip_z - c * rate_z,
    )


def shear_return(
    law: Law,
    ex: float,
    ez: float,
    ex_old: float,
    ez_old: float,
    rate_x: float,
    rate_z: float,
    tau: float,
    dt: float,
) -> tuple[float, float, float, float, bool]:
    """Return (t_x, t_z, ex, ez, slipped) from the trial elastic slip and the strength tau.

    What exceeds the strength is scaled back along its direction. The elastic slip is then where
    spring and dashpot carry that traction: e = (e* + h e_old) / (1 + h), e* = -T / K_s and
    h = C_s / (K_s dt).
    """
    t_x, t_z = shear_traction(law, ex, ez, rate_x, rate_z)
    if hypot(t_x, t_z) <= tau:
        return t_x, t_z, ex, ez, False
    scale = tau / hypot(t_x, t_z)
    t_x, t_z = scale * t_x, scale * t_z
    h = (law.shear_viscosity or 0.0) / (law.shear_stiffness * dt)
    ex = (-t_x / law.shear_stiffness + h * ex_old) / (1 + h)
    ez = (-t_z / law.shear_stiffness + h * ez_old) / (1 + h)
    return t_x, t_z, ex, ez, True


def traction(
    law: Law,
    gap: float,
    gap_rate: float,
    slip: tuple[float, float],
    slip_rate: tuple[float, float],
    dt: float,
    history: History,
) -> tuple[float, float, float, History]:
    """Return (t_n, t_x, t_z, history) after a step: the normal part, then shear under it.

    The first slip of a point leaves no more than the residual cohesion.
    """
    opening, cohesion = update_opening(history.opening, gap), history.cohesion
    t_n = normal_traction(law, gap, gap_rate, opening)
    if history.ex is None:
        return t_n, 0.0, 0.0, history._replace(opening=opening)
    tau = shear_strength(law, t_n, gap, opening, cohesion)
    trial = history.ex + slip[0], history.ez + slip[1]
    t_x, t_z, ex, ez, slipped = shear_return(
        law, *trial, history.ex, history.ez, *slip_rate, tau, dt
    )
    if slipped and cohesion is not None:
        cohesion = min(cohesion, law.residual_cohesion)
    return t_n, t_x, t_z, History(opening, ex, ez, cohesion)


def elastic_energy(
    law: Law,
    gap: float,
    opening: float | None = None,
    ex: Any = None,
    ez: Any = None,
) -> float:
    """Return what the springs store, J/m2: half of stiffness times elastic displacement squared."""
    stiffness = law.normal_stiffness
    if gap > 0:
        stiffness = secant_stiffness(law, opening) if holds(law, gap, opening) else 0.0
    normal = stiffness * gap**2 / 2
    return normal if ex is None else normal + law.shear_stiffness * (ex**2 + ez**2) / 2


def friction_work(
    law: Law, ex_old: float, ez_old: float, ex: float, ez: float, dx: float, dz: float
) -> float:
    """Return what sliding takes, J/m2: the mean spring force times the slide, slip less elastic."""
    slide_x, slide_z = dx - (ex - ex_old), dz - (ez - ez_old)
    return law.shear_stiffness * ((ex_old + ex) * slide_x + (ez_old + ez) * slide_z) / 2


def fracture_energy_spent(law: Law, opening: float) -> float:
    """Return what is lost by opening, J/m2: the area under the curve less the secant triangle."""
    first = law.tensile_strength / law.normal_stiffness
    if opening <= first:
        return 0.0
    end = min(opening, law.critical_opening)
    left = strength_left(law, end)
    area = law.tensile_strength * first / 2 + (law.tensile_strength + left) / 2 * (end - first)
    return area - left * end / 2
