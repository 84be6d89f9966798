"""What holds the two ends of the chain, as a half-block spring and a dashpot on the end block.

Everything is written for the outward motion x of the end block, with the reaction positive in
compression. The dashpot sees the mean of the velocities before and after the step, solved on the
one block, so no end changes the critical step by its dashpot.
"""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from cases.calibrate import Properties
from joints.ends import HalfSpring, half_spring
from joints.jit import jitted


class End(NamedTuple):
    """One end; a free end is None instead.

    stiffness : N/m, of the spring's closure w in the reaction; None for a bare dashpot.
    viscosity : N s/m, of the block's own velocity in the reaction.
    half_step : dt / 2 m, s/kg.
    decay, gain : w <- decay w + gain v; gain is dt for a rigid wall, s.
    """

    stiffness: Any
    viscosity: float
    half_step: float
    decay: float
    gain: float


def build_end(kind: str, p: Properties, dt: float) -> End | None:
    """Return the end of this kind for a step dt (s).

    free: None. quiet: -rho c v A on the end block (9). matched: the same dashpot behind the
    half-block spring 2 k; fixed: that spring to a wall (`joints.ends`).
    """
    if kind == "free":
        return None
    half_step = dt / (2 * p.block_mass)
    if kind == "quiet":
        return End(None, p.impedance * p.area, half_step, 0.0, 0.0)
    spring = _half_block(kind, p, dt)
    return End(spring.stiffness, spring.viscosity, half_step, spring.decay, spring.gain)


def end_stiffness(kind: str, p: Properties) -> float:
    """Return what the end adds to the end block's stiffness at the critical step, N/m."""
    return 0.0 if kind in ("free", "quiet") else _half_block(kind, p).critical_stiffness


def _half_block(kind: str, p: Properties, dt: float = 0.0) -> HalfSpring:
    z = inf if kind == "fixed" else p.impedance * p.area
    return half_spring(2 * p.regular_stiffness * p.area, p.time_constant or 0.0, z, dt)


def end_state(end: End | None) -> np.ndarray | None:
    """Return the state of an end at rest: [closure w (m), reaction at the last step (N)]."""
    return None if end is None else np.zeros(2)


@jitted
def _spring(stiffness, w):
    if stiffness is None:
        return 0.0
    return stiffness * w


@jitted
def advance_end(end, state, x, v, push):
    """Return the outward velocity of the end block after the step.

    v is that before it and push the outward force of everything but the end, times dt / m in x.
    The reaction and the closure are left in `state`.
    """
    if end is None:
        return v + x * push
    spring = _spring(end.stiffness, state[0])
    beta = end.half_step * end.viscosity
    v_new = ((1.0 - beta) * v + x * (push - spring)) / (1.0 + beta)
    state[1] = spring + 0.5 * end.viscosity * (v + v_new)
    state[0] = end.decay * state[0] + end.gain * v_new
    return v_new


@jitted
def reaction(state):
    """Return the reaction (N) at the last step, compression positive."""
    if state is None:
        return 0.0
    return state[1]
