"""Shear traction of a joint: spring and dashpot up to Coulomb's strength, equation (3).

The traction acts on the right block, in the two directions x and z of the face. The elastic part
e of the slip is its memory: a step adds the increment of slip, and what exceeds the strength is
scaled back along its own direction (radial return). With T* = -K_s e - C_s de/dt on the strength
and de/dt taken over the step, e is where spring and dashpot together carry exactly T*.
"""

from math import sqrt

from joints.softening import is_broken, strength_left
from numerics.jit import inlined, jitted

# Pa; more than any joint carries, and still a number when squared.
UNLIMITED = 1e100


@inlined
def shear_traction(law, slip_x, slip_z, rate_x, rate_z):
    """Return (t_x, t_z) (Pa) where nothing slides, from the whole slip (m) and its rate."""
    t_x = _with_dashpot(-law.shear_stiffness * slip_x, law.shear_viscosity, rate_x)
    t_z = _with_dashpot(-law.shear_stiffness * slip_z, law.shear_viscosity, rate_z)
    return t_x, t_z


@jitted
def shear_strength(law, t_n, gap, opening=None, cohesion=None):
    """Return what |T| cannot exceed (Pa), or None where nothing limits it.

    c s(k) / s_t + t_n tan(phi), not below zero; zero where the joint does not hold.

    t_n, gap : normal traction, Pa, and gap, m.
    opening : the largest so far, m; None without softening.
    cohesion : of this point, Pa; None where slip does not change it.
    """
    tau = _coulomb(law.cohesion, law.friction, cohesion, law, t_n, opening)
    return _where_it_holds(tau, law.carries_tension, law.tensile_strength, law, gap, opening)


@inlined
def _coulomb(own_cohesion, friction, cohesion, law, t_n, opening):
    if own_cohesion is None and friction is None:
        return None
    c = _cohesion_left(own_cohesion, cohesion, law.tensile_strength, law, opening)
    return max(_with_friction(c, friction, t_n), 0.0)


@inlined
def _cohesion_left(own_cohesion, cohesion, strength, law, opening):
    if own_cohesion is None:
        return 0.0
    c = _of_this_point(own_cohesion, cohesion)
    if strength is None:
        return c
    # Where cohesion stands for no limit at all, broken faces that touch have none either.
    return c if c >= UNLIMITED else c * (strength_left(law, opening) / strength)


@inlined
def _of_this_point(own_cohesion, cohesion):
    if cohesion is None:
        return own_cohesion
    return cohesion


@inlined
def _with_friction(c, friction, t_n):
    if friction is None:
        return c
    return c + t_n * friction


@inlined
def _where_it_holds(tau, carries_tension, strength, law, gap, opening):
    if carries_tension is None and strength is None:
        return tau
    return _or_unlimited(tau) if holds(law, gap, opening) else 0.0


@inlined
def _or_unlimited(tau):
    if tau is None:
        return UNLIMITED
    return tau


@inlined
def holds(law, gap, opening=None):
    """Return whether the two faces hold each other: not where open without tension, or broken."""
    return gap <= 0.0 or (_holds_open(law.carries_tension) and not is_broken(law, opening))


@inlined
def _holds_open(carries_tension):
    if carries_tension is None:
        return True
    return carries_tension


@jitted
def shear_return(law, ex, ez, ex_old, ez_old, rate_x, rate_z, tau, dt):
    """Return (t_x, t_z, ex, ez, slipped) at the end of a step.

    ex, ez : trial elastic slip, the old one and the whole increment, m.
    ex_old, ez_old : elastic slip before the step, m; rate_x, rate_z : of the slip, m/s.
    tau : strength, Pa, None where unlimited; dt : the step, s.
    """
    t_x, t_z = shear_traction(law, ex, ez, rate_x, rate_z)
    return _radial_return(law, t_x, t_z, ex, ez, ex_old, ez_old, tau, dt)


@inlined
def _radial_return(law, t_x, t_z, ex, ez, ex_old, ez_old, tau, dt):
    if tau is None:
        return t_x, t_z, ex, ez, False
    square = t_x * t_x + t_z * t_z
    slipped = square > tau * tau
    scale = tau / sqrt(square) if slipped else 1.0
    t_x, t_z = scale * t_x, scale * t_z
    x = _elastic_slip(scale * ex, t_x, ex_old, law.shear_viscosity, law.shear_stiffness, dt)
    z = _elastic_slip(scale * ez, t_z, ez_old, law.shear_viscosity, law.shear_stiffness, dt)
    return t_x, t_z, x if slipped else ex, z if slipped else ez, slipped


@inlined
def _elastic_slip(scaled, t, old, viscosity, stiffness, dt):
    if viscosity is None:
        return scaled
    # t = -K_s e - C_s (e - old) / dt, solved for e.
    drag = viscosity / dt
    return (drag * old - t) / (stiffness + drag)


@jitted
def cohesion_left(law, cohesion, slipped):
    """Return the cohesion (Pa) of a point after a step; None where slip does not change it."""
    if cohesion is None:
        return None
    return min(cohesion, law.residual_cohesion) if slipped else cohesion


@inlined
def _with_dashpot(t, viscosity, rate):
    if viscosity is None:
        return t
    return t - viscosity * rate
