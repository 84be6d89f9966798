"""The motion of fixed sides that move as a base, in any dimension."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jointwave.cases.loads import history_of
from jointwave.cases.schema.sources import PlaneLoad

#: Of (steps): the velocity of every wall in each [n, walls, d], m/s.
Shaking = Callable[[np.ndarray], np.ndarray]


def shaking(bases: list[PlaneLoad], walls: tuple[str, ...], dim: int, dt: float) -> Shaking | None:
    """Return the motion of walls, named by their sides, in steps of dt (s); None without a base.

    A velocity is the mean over the step, so that displacements are exact; an acceleration gives
    the velocity at the half step, as leapfrog does.
    """
    if not bases:
        return None

    def velocity(steps: np.ndarray) -> np.ndarray:
        found = np.zeros((len(steps), len(walls), dim))
        for one in bases:
            history = history_of(one, one.amplitude)
            if one.quantity == "velocity":
                along = np.diff(history.impulse(dt * np.append(steps, steps[-1:] + 1))) / dt
            else:
                along = history.impulse(dt * (steps + 0.5))
            found[:, walls.index(one.side or "")] += np.outer(along, one.direction or [])
        return found

    return velocity


def variation(velocity: np.ndarray) -> float:
    """Return the total variation of the velocities of walls [n, walls, d], m/s."""
    still = np.zeros_like(velocity[:1])
    steps = np.diff(velocity, axis=0, prepend=still, append=still)
    return float(np.sqrt((steps**2).sum(axis=(1, 2))).sum())
