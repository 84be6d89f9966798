"""The given motion of held freedoms, at any time within the steps of an implicit run."""

from typing import NamedTuple

import numpy as np

from continuum.model import Held


class Wall(NamedTuple):
    """Freedoms that move as they are told.

    freedom, way : [k]; all move by way times the same displacement (m), velocity and acceleration,
    each float array [steps + 1] at whole steps; None where they stand still.
    """

    freedom: np.ndarray
    way: np.ndarray
    motion: np.ndarray | None


def wall(held: Held | None, dt: float) -> Wall:
    """Return the motion of held freedoms; dt : of whole steps, s.

    Displacements are sums of the given steps; velocity and acceleration are centred differences
    of them, of second order, with the wall at rest before t = 0.
    """
    if held is None:
        return Wall(np.zeros(0, dtype=np.int64), np.zeros(0), None)
    if held.step is None:
        return Wall(held.freedom, held.way, None)
    before = np.concatenate([[0.0], held.step[:-1]])
    motion = [np.cumsum(before), (before + held.step) / (2 * dt), (held.step - before) / dt**2]
    return Wall(held.freedom, held.way, np.array(motion))


def motion_at(wall: Wall, n: int, share: float) -> np.ndarray:
    """Return displacement, velocity and acceleration [3, k] at step n and a share of the next."""
    if wall.motion is None:
        return np.zeros((3, wall.freedom.size))
    first = wall.motion[:, n]
    last = wall.motion[:, n + 1] if share else first
    return np.outer((1 - share) * first + share * last, wall.way)
