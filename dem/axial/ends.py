"""What holds the two ends of the chain, as a half-block spring and a dashpot on the end block.

Everything is written for the outward motion x of the end block, with the reaction positive in
compression. The dashpot sees the mean of the velocities before and after the step, solved on the
one block, so no end changes the critical step by its dashpot.
"""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from cases.material.calibrate import Properties
from dem.axial.motion import advanced
from dem.damping import kept
from joints.ends import HalfSpring, half_spring
from numerics.jit import inlined


class End(NamedTuple):
    """One end; a free end is None instead.

    stiffness : N/m, of the spring's closure w in the reaction; None for a bare dashpot.
    viscosity : N s/m, of the block's own velocity in the reaction, less that of a shaken wall.
    decay, gain : w <- decay w + gain v; gain is dt for a rigid wall, s.
    """

    stiffness: Any
    viscosity: float
    decay: float
    gain: float


def build_end(kind: str, p: Properties, dt: float) -> End | None:
    """Return the end of this kind for a step dt (s).

    free: None. quiet: -rho c v A on the end block (9). matched: the same dashpot behind the
    half-block spring 2 k; fixed: that spring to a wall (`joints.ends`).
    """
    if kind == "free":
        return None
    if kind == "quiet":
        return End(None, p.impedance * p.area, 0.0, 0.0)
    spring = _half_block(kind, p, dt)
    return End(spring.stiffness, spring.viscosity, spring.decay, spring.gain)


def end_stiffness(kind: str, p: Properties) -> float:
    """Return what the end adds to the end block's stiffness at the critical step, N/m."""
    return 0.0 if kind in ("free", "quiet") else _half_block(kind, p).critical_stiffness


def _half_block(kind: str, p: Properties, dt: float = 0.0) -> HalfSpring:
    z = inf if kind == "fixed" else p.impedance * p.area
    return half_spring(2 * p.regular_stiffness * p.area, p.time_constant or 0.0, z, dt)


def end_state(end: End | None) -> np.ndarray | None:
    """Return the state of an end at rest: [closure w (m), reaction at the last step (N)]."""
    return None if end is None else np.zeros(2)


@inlined
def advance_end(chain, ledger, end, state, j, v, push, before, after):
    """Return the outward velocity of block j, at an end, after the step.

    v : before it. push : the outward force of everything but the end, N. before, after : the
    outward way of a shaken wall in the step before and in this one, m; None where it stands.
    The reaction and the closure are left in `state`. Without the end the velocity would be v*; the
    dashpot c answers the mean (v + v* - (dt / m) r) / 2, which is solved for the reaction r.
    """
    if end is None:
        return advanced(chain, ledger, j, v, push)
    x, c = chain.impulse_to_speed, end.viscosity
    pace = v + (kept(chain.keep, v) + x * push)
    drag = 0.5 * c * _less_wall(pace, before, after, chain.dt)
    state[1] = (_spring(end.stiffness, state[0]) + drag) / (1.0 + 0.5 * x * c)
    v_new = advanced(chain, ledger, j, v, push - state[1])
    state[0] = _less(end.decay * state[0] + end.gain * v_new, after)
    return v_new


@inlined
def _spring(stiffness, closure):
    if stiffness is None:
        return 0.0
    return stiffness * closure


@inlined
def _less_wall(pace, before, after, dt):
    if before is None:
        return pace
    return pace - (before + after) / dt


@inlined
def _less(closure, after):
    if after is None:
        return closure
    return closure - after


@inlined
def reaction(state):
    """Return the reaction (N) at the last step, compression positive."""
    if state is None:
        return 0.0
    return state[1]
