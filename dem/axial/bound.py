"""A bound on the speed of a chain, for the divergence monitor."""

import numpy as np

from cases.sampling import Clock
from dem.axial.model import Model
from dem.axial.state import State
from numerics.divergence import speed_that


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
