"""The law of a joint, compiled: its parts, its memory, and the whole of it in one call.

A law is a NamedTuple whose absent parts are None. numba compiles one traction for each combination
of present parts and drops the branches of absent ones, so an absent part leaves no instruction
behind. A part is one number when all joints are alike and an array over joints when they differ.

Per unit area: traction in Pa, compression positive; gap in m, positive when open, so that
penetration is negative. `joints.reference` says the same in plain Python.
"""

from typing import Any, NamedTuple

from numba import types
from numba.extending import overload

from joints.normal import normal_traction, spring_traction
from joints.shear import cohesion_left, shear_return, shear_strength
from joints.softening import update_opening
from numerics.jit import inlined, jitted

__all__ = ["History", "Law", "law_of", "normal_traction", "pick", "spring_traction", "traction"]


class Law(NamedTuple):
    """The law of all joints, or of one joint.

    normal_stiffness, normal_viscosity : K, Pa/m, and K eta, Pa s/m; None without dashpots.
    carries_tension : whether tension is carried; None where every joint does.
    shear_stiffness, shear_viscosity : K_s, Pa/m, and K_s eta, Pa s/m; None without shear.
    cohesion, friction : c, Pa, and tan(phi); None where no joint slides.
    residual_cohesion : what slip leaves of the cohesion, Pa; None where it leaves all.
    tensile_strength, critical_opening : s_t, Pa, and w_c, m; None without softening.

    A joint without a strength that others have is given `joints.shear.UNLIMITED`.
    """

    normal_stiffness: Any
    normal_viscosity: Any = None
    carries_tension: Any = None
    shear_stiffness: Any = None
    shear_viscosity: Any = None
    cohesion: Any = None
    friction: Any = None
    residual_cohesion: Any = None
    tensile_strength: Any = None
    critical_opening: Any = None


class History(NamedTuple):
    """What one point of a joint remembers.

    opening : the largest so far, m; None without softening.
    ex, ez : elastic part of the slip, m; None without shear.
    cohesion : of this point, Pa; None without residual cohesion.
    """

    opening: Any = None
    ex: Any = None
    ez: Any = None
    cohesion: Any = None


def pick(part, j):
    """Return a law's part for joint j: None, the one number, or the j-th of an array."""
    return part[j] if hasattr(part, "__getitem__") else part


@overload(pick)
def _pick(part, j):
    if isinstance(part, types.Array):
        return lambda part, j: part[j]
    return lambda part, j: part


@jitted
def law_of(law, j):
    """Return the law of joint j, every part a number or None."""
    return Law(
        pick(law.normal_stiffness, j),
        pick(law.normal_viscosity, j),
        pick(law.carries_tension, j),
        pick(law.shear_stiffness, j),
        pick(law.shear_viscosity, j),
        pick(law.cohesion, j),
        pick(law.friction, j),
        pick(law.residual_cohesion, j),
        pick(law.tensile_strength, j),
        pick(law.critical_opening, j),
    )


@jitted
def traction(law, gap, gap_rate, slip, slip_rate, dt, history):
    """Return (t_n, t_x, t_z, history) of one point after a step: the whole law.

    gap, gap_rate : m and m/s at the end of the step; slip : its increments (dx, dz) over the
    step, m; slip_rate : (x, z), m/s; dt : s; history : before the step.
    """
    opening = update_opening(history.opening, gap)
    t_n = normal_traction(law, gap, gap_rate, opening)
    t_x, t_z, ex, ez, cohesion = _shear(
        law, t_n, gap, slip, slip_rate, dt, opening, history.ex, history.ez, history.cohesion
    )
    return t_n, t_x, t_z, History(opening, ex, ez, cohesion)


@inlined
def _shear(law, t_n, gap, slip, slip_rate, dt, opening, ex, ez, cohesion):
    if ex is None:
        return 0.0, 0.0, None, None, cohesion
    tau = shear_strength(law, t_n, gap, opening, cohesion)
    x, z = ex + slip[0], ez + slip[1]
    t_x, t_z, x, z, slipped = shear_return(law, x, z, ex, ez, slip_rate[0], slip_rate[1], tau, dt)
    return t_x, t_z, x, z, cohesion_left(law, cohesion, slipped)
