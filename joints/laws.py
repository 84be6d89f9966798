"""Tractions of a joint, compiled: elastic, dashpot, no tension.

A law is a NamedTuple whose absent parts are None. numba compiles one traction for each combination
of present parts and drops the branches of absent ones, so an absent part leaves no instruction
behind. A part is one number when all joints are alike and an array over joints when they differ.

Per unit area: traction in Pa, compression positive; gap in m, positive when open, so that
penetration is negative. `joints.reference` says the same in plain Python.
"""

from typing import Any, NamedTuple

from numba import types
from numba.extending import overload

from joints.jit import jitted


class Law(NamedTuple):
    """The law of all joints, or of one joint.

    normal_stiffness : K, Pa/m.
    normal_viscosity : K eta, Pa s/m; None without dashpots.
    carries_tension : whether tension is carried; None where every joint does.
    """

    normal_stiffness: Any
    normal_viscosity: Any = None
    carries_tension: Any = None


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
    )


@jitted
def _with_dashpot(t, viscosity, gap_rate):
    if viscosity is None:
        return t
    return t - viscosity * gap_rate


@jitted
def _without_tension(t, carries_tension, gap):
    if carries_tension is None:
        return t
    if carries_tension:
        return t
    return max(t, 0.0) if gap <= 0.0 else 0.0


@jitted
def normal_traction(law, gap, gap_rate):
    """Return t_n (Pa) of one joint: spring and dashpot, the whole cut at zero by no tension (10).

    The total gap decides opening; a force kept by increments would forget it.
    """
    t = _with_dashpot(-law.normal_stiffness * gap, law.normal_viscosity, gap_rate)
    return _without_tension(t, law.carries_tension, gap)


@jitted
def spring_traction(law, gap):
    """Return the elastic part of t_n (Pa): what is stored, not dissipated."""
    return _without_tension(-law.normal_stiffness * gap, law.carries_tension, gap)
