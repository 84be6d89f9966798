"""Bounds of the chain: its critical step, and how fast its blocks can become.

The critical step is exact, from the largest eigenvalue with all dashpots.

Mass-proportional damping takes the mean velocity of the step and leaves the bound as it is: in the
mode that alternates at every step that mean is zero. Softening, like slip, only takes stiffness
away. Local damping can add a share of every unbalanced force to it, as if the stiffness were
1 + local times itself.
"""

from __future__ import annotations

from math import cos, pi, sqrt

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Clock
from jointwave.dem.axial.ends import end_stiffness
from jointwave.dem.axial.model import Model
from jointwave.dem.axial.state import State
from jointwave.numerics.critical_step import critical_step, critical_step_of_modes
from jointwave.numerics.divergence import speed_that


def critical_chain_step(p: Properties, start: str, end: str) -> float:
    """Return the critical step (s) of a chain whose ends are held as `start` and `end` say."""
    alike = p.is_uniform and (p.stiffness == p.stiffness[0]).all() and not p.damps_alone.any()
    pushed = 1 + (p.local_damping or 0.0)
    if alike and {start, end} <= {"free", "quiet"}:
        rigid = 2 * sqrt(p.stiffness[0] * p.area / p.block_mass)
        omega = rigid * cos(pi / (2 * p.block_count))
        return critical_step_of_modes(omega * sqrt(pushed), p.time_constant or 0.0)

    from scipy.linalg import eigh_tridiagonal  # slow to import: only for chains that need it

    k = p.stiffness * p.area
    c = k * (0.0 if p.joint_time_constant is None else p.joint_time_constant)
    ends = np.zeros(p.block_count)
    ends[0], ends[-1] = end_stiffness(start, p.at_start), end_stiffness(end, p.at_end)
    masses = p.masses
    lightness = np.ones(p.block_count) if masses is None else p.block_mass / masses

    def largest(a: float, b: float) -> float:
        joints = a * k + b * c
        diagonal = a * ends
        diagonal[:-1] += joints
        diagonal[1:] += joints
        diagonal *= lightness
        joints *= np.sqrt(lightness[1:] * lightness[:-1])
        last = (p.block_count - 1,) * 2
        top = eigh_tridiagonal(diagonal, -joints, True, select="i", select_range=last)
        return pushed * top[0] / p.block_mass

    return critical_step(largest, p.joint_time_constant is not None)


def highest_speed(model: Model, state: State, time: Clock) -> float:
    """Return a bound on the speed of any block, m/s.

    From the load, weight and prestress on blocks of mass m, the motion of a base (in whose frame
    all blocks are loaded), and the energy stored in joints and ends at the start.
    """
    c, blocks = model.chain, state.u.size
    duration = time.dt * (time.steps + time.stride)
    with np.errstate(over="ignore"):
        return speed_that(
            time.dt * (np.abs(model.load) / c.mass).sum(),
            duration * (abs(c.start_force) + abs(c.end_force)) / c.mass,
            duration * np.sqrt(blocks) * c.weight / c.mass,
            np.sqrt(blocks) * shaking(model.base, time.dt),
            stored(model, state) / np.sqrt(c.mass),
        )


def shaking(base: np.ndarray | None, dt: float) -> float:
    """Return the total variation of the velocity of a moving base, m/s, from its displacement
    increments (m); 0 without."""
    if base is None:
        return 0.0
    return float(np.abs(np.diff(base, prepend=0.0, append=0.0)).sum() / dt)


def stored(model: Model, state: State) -> float:
    """Return the root of twice the energy in all springs, sqrt(J)."""
    c, stiffness = model.chain, model.laws[0]
    joints = np.sqrt(stiffness * c.area) * np.diff(state.u)
    ends = [
        np.sqrt(end.stiffness) * closure
        for end, (closure, _) in ((c.start, state.start), (c.end, state.end))
    ]
    return float(np.hypot(np.linalg.norm(joints), np.linalg.norm(ends)))
