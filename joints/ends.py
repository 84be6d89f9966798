"""A dashpot behind a spring: it absorbs waves at the end of a row of joints.

The spring, half of a joint or of a block and its joint, joins the last mass to the massless end
face, which rests on the dashpot Z of the rock beyond, or on a rigid wall. With the spring's closure
w, the velocity v of the mass and the reaction f (compression positive)

    f = k (w + eta dw/dt),   dw/dt = v - f / Z,   so   f = share k (w + eta v),
    share = 1 / (1 + k eta / Z).

w is advanced with the mean of f over the step: second order, without a bound on the step.
"""

from math import inf
from typing import Any, NamedTuple


class HalfSpring(NamedTuple):
    """An end, or arrays of several ends, for a given step.

    stiffness, viscosity : of f = stiffness w + viscosity v, N/m and N s/m.
    decay, gain : of w <- decay w + gain v, with v half a step later; gain in s.
    critical_stiffness : of the mass at the critical step, N/m: in the mode that alternates at every
        step the face hardly moves.
    """

    stiffness: Any
    viscosity: Any
    decay: Any
    gain: Any
    critical_stiffness: Any


def half_spring(k: Any, eta: Any, z: Any = inf, dt: float = 0.0) -> HalfSpring:
    """Return the end of spring k, N/m, time constant eta, s, and dashpot z, N s/m (inf: a wall)."""
    share = 1 / (1 + k * eta / z)
    lag = dt * k * share / (2 * z)
    return HalfSpring(
        stiffness=share * k,
        viscosity=share * k * eta,
        decay=(1 - lag) / (1 + lag),
        gain=dt * share / (1 + lag),
        critical_stiffness=share**2 * k,
    )
