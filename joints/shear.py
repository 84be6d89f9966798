"""Shear traction of a joint: spring and dashpot up to Coulomb's strength, equation (3).

The traction acts on the right block, in the two directions x and z of the face. The history is the
elastic part e of the slip: a step adds the increment of slip, and traction above the strength is
scaled back along its own direction (radial return). e is then updated so that spring and dashpot,
-K_s e - C_s de/dt with de/dt over the step, carry exactly the strength.
"""

from math import copysign, sqrt

from jointwave.joints.formula import formula
from jointwave.joints.softening import is_broken, strength_left
from jointwave.joints.weakening import friction_left

# Pa; above any strength, with a finite square.
UNLIMITED = 1e100


@formula
def shear_traction(law, parts, slip_x, slip_z, rate_x, rate_z):
    """Return (t_x, t_z) (Pa) of spring and dashpot, from the slip (m) and its rate (m/s)."""
    t_x, t_z = -law.shear_stiffness * slip_x, 0.0
    if not parts.planar:
        t_z = -law.shear_stiffness * slip_z
    if parts.dashpots:
        t_x = t_x - law.shear_viscosity * rate_x
        if not parts.planar:
            t_z = t_z - law.shear_viscosity * rate_z
    return t_x, t_z


@formula
def size_of(parts, t_x, t_z):
    """Return |T| (Pa)."""
    return abs(t_x) if parts.planar else sqrt(t_x * t_x + t_z * t_z)


@formula
def shear_strength(law, parts, t_n, gap, opening, cohesion, path):
    """Return the limit of |T| (Pa); `UNLIMITED` where there is none.

    c s(k) / s_t + t_n tan(phi), at least zero; zero where faces are separated; without the friction
    if that depends on the slip rate.

    t_n, gap : normal traction, Pa, and gap, m.
    opening : the largest so far, m. cohesion : of this point, Pa, where slip changes it.
    path : its accumulated slip, m, where that weakens it.
    """
    tau = UNLIMITED
    if parts.slip:
        c = cohesion if parts.residual else law.cohesion
        # An unlimited cohesion stays unlimited where broken faces touch.
        if parts.softening and c < UNLIMITED:
            c = c * (strength_left(law, opening) / law.tensile_strength)
        # Rate-dependent friction is added by `joints.slide`.
        if not parts.rate_state or law.direct_effect == 0.0:
            c = c + t_n * friction_left(law, parts, t_n, path)
            c = 0.0 if c < 0.0 else c
        tau = c
    return tau if holds(law, parts, gap, opening) else 0.0


@formula
def holds(law, parts, gap, opening):
    """Return whether the faces are in contact or bonded (tension carried and not broken)."""
    pulls = (not parts.no_tension or law.carries_tension != 0.0) and not is_broken(
        law, parts, opening
    )
    return gap <= 0.0 or pulls


@formula
def resistance(law, parts, dt):
    """Return the decrease of traction per slip within a step, Pa/m: spring and dashpot."""
    if parts.dashpots:
        return law.shear_stiffness + law.shear_viscosity / dt
    return law.shear_stiffness


@formula
def shear_return(law, parts, ex, ez, ex_old, ez_old, rate_x, rate_z, tau, dt):
    """Return (t_x, t_z, ex, ez, slipped) at the end of a step.

    ex, ez : trial elastic slip, the old one plus the increment of slip, m. ex_old, ez_old : elastic
    slip before the step, m. rate_x, rate_z : of the slip, m/s. tau : strength, Pa. dt : s.
    """
    t_x, t_z = shear_traction(law, parts, ex, ez, rate_x, rate_z)
    if not parts.limited:
        return t_x, t_z, ex, ez, False
    if parts.planar:
        slipped = abs(t_x) > tau
        t_x = copysign(tau, t_x) if slipped else t_x
        scaled_x, scaled_z = -t_x / law.shear_stiffness, 0.0
    else:
        square = t_x * t_x + t_z * t_z
        slipped = square > tau * tau
        scale = tau / sqrt(square) if slipped else 1.0
        t_x, t_z, scaled_x, scaled_z = scale * t_x, scale * t_z, scale * ex, scale * ez
    x = _elastic_slip(law, parts, scaled_x, t_x, ex_old, dt)
    z = 0.0 if parts.planar else _elastic_slip(law, parts, scaled_z, t_z, ez_old, dt)
    return t_x, t_z, x if slipped else ex, z if slipped else ez, slipped


@formula
def _elastic_slip(law, parts, scaled, t, old, dt):
    if not parts.dashpots:
        return scaled
    # t = -K_s e - C_s (e - old) / dt, solved for e.
    drag = law.shear_viscosity / dt
    return (drag * old - t) * (1.0 / (law.shear_stiffness + drag))


@formula
def cohesion_left(law, parts, cohesion, slipped):
    """Return the cohesion (Pa) of a point after a step, where slip changes it."""
    if parts.residual and slipped:
        return law.residual_cohesion if law.residual_cohesion < cohesion else cohesion
    return cohesion
