"""How fast a chain can become at most: what its run is held to."""

import numpy as np

from cases.sampling import Clock
from dem.axial.model import Model
from dem.axial.state import State
from numerics.divergence import speed_that


def highest_speed(model: Model, state: State, time: Clock) -> float:
    """Return a bound on the speed of any block, m/s.

    What the load, the weight and a prestress can push into blocks of mass m, the way a base is
    shaken, in whose frame all blocks are pushed, and what joints and ends store at the start.
    """
    chain, blocks = model.chain, state.u.size
    m, duration = chain.mass, time.dt * (time.steps + time.stride)
    steady = np.abs(chain.steady).sum() if chain.steady else 0.0
    with np.errstate(over="ignore"):
        return speed_that(
            time.dt * (np.abs(model.load) / m).sum(),
            duration * steady / m,
            duration * np.sqrt(blocks) * (chain.weight or 0.0) / m,
            np.sqrt(blocks) * shaking(model.base, time.dt),
            stored(model, state) / np.sqrt(m),
        )


def shaking(base: np.ndarray | None, dt: float) -> float:
    """Return the total variation of the velocity of a shaken base, m/s, given its steps (m)."""
    if base is None:
        return 0.0
    return float(np.abs(np.diff(base, prepend=0.0, append=0.0)).sum() / dt)


def stored(model: Model, state: State) -> float:
    """Return the root of twice the energy in all springs, sqrt(J)."""
    chain = model.chain
    joints = np.sqrt(np.asarray(chain.law.normal_stiffness) * chain.area) * np.diff(state.u)
    ends = [
        np.sqrt(end.stiffness) * kept[0]
        for end, kept in ((chain.start, state.start), (chain.end, state.end))
        if end is not None and end.stiffness is not None
    ]
    return float(np.hypot(np.linalg.norm(joints), np.linalg.norm(ends)))
