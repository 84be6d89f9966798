"""The two ends of the chain: a spring and a dashpot on the end block.

Everything is written for the outward motion of the end block, with the reaction positive in
compression.
"""

from math import inf
from typing import NamedTuple

from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.joints.ends import HalfSpring, half_spring
from jointwave.joints.formula import formula


class End(NamedTuple):
    """One end; all zero where it is free.

    stiffness : N/m, of the spring's closure w in the reaction; 0 for a bare dashpot.
    viscosity : N s/m, of the block's own velocity in the reaction, less that of a shaken wall.
    decay, gain : w <- decay w + gain v; 1 and dt for a rigid wall, gain in s.
    """

    stiffness: float = 0.0
    viscosity: float = 0.0
    decay: float = 0.0
    gain: float = 0.0


def build_end(kind: str, p: JointedRock, dt: float) -> End:
    """Return the end of this kind for a step dt (s).

    quiet: -rho c v A on the end block (9). matched: the same dashpot behind the half-block spring
    2 k; fixed: half a block of rock to a wall (`joints.ends`).
    """
    if kind == "free":
        return End()
    if kind == "quiet":
        return End(viscosity=p.impedance * p.area)
    spring = _spring(kind, p, dt)
    return End(spring.stiffness, spring.viscosity, spring.decay, spring.gain)


def end_stiffness(kind: str, p: JointedRock) -> float:
    """Return the end's contribution to the end block's stiffness at the critical step, N/m."""
    return 0.0 if kind in ("free", "quiet") else _spring(kind, p).critical_stiffness


def _spring(kind: str, p: JointedRock, dt: float = 0.0) -> HalfSpring:
    fixed, eta = kind == "fixed", p.time_constant or 0.0
    stiffness = p.wall_stiffness if fixed else 2 * p.regular_stiffness
    return half_spring(stiffness * p.area, eta, inf if fixed else p.impedance * p.area, dt)


@formula
def end_reaction(c, end, x, w, v, force, wall):
    """Return the reaction (N, compression positive) of an end: k w + c (v + v') / 2.

    c : `dem.axial.model.Chain`; end : `End`; x : `impulse_to_speed` of the end block; w : closure
    of its spring, m. v : outward velocity of the end block before the step, m/s; force : the
    outward force on it of everything else, N. wall : sum of a shaken wall's outward velocities in
    the step before and in this one, m/s.
    The velocity after the step, v' = keep v + (dt / m) (force - reaction), is solved on the one
    block, so no dashpot of an end changes the critical step.
    """
    pace = v + (c.keep * v + x * force) - wall
    spring, drag = end.stiffness * w, 0.5 * end.viscosity * pace
    return (spring + drag) / (1.0 + 0.5 * x * end.viscosity)
