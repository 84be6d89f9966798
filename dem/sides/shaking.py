"""The motion of walls that are moving bases, in any dimension."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jointwave.cases.loads import history_of
from jointwave.cases.schema.pulse import Pulse
from jointwave.dem.kernel.model import State

#: A function of steps [n] that returns the velocity of every wall in each [n, walls, d], m/s.
Shaking = Callable[[np.ndarray], np.ndarray]


class Base(NamedTuple):
    """A moving base: the wall's name, the pulse of its motion, and its direction [d]."""

    wall: str
    pulse: Pulse
    direction: np.ndarray


def shaking(bases: list[Base], walls: tuple[str, ...], dim: int, dt: float) -> Shaking | None:
    """Return the motion of walls in steps of dt (s); None without a base.

    A velocity is the mean over the step, so that displacements are exact; an acceleration gives
    the velocity at the half step, as leapfrog does.
    """
    if not bases:
        return None

    def velocity(steps: np.ndarray) -> np.ndarray:
        found = np.zeros((len(steps), len(walls), dim))
        for wall, pulse, direction in bases:
            history = history_of(pulse, pulse.amplitude)
            if pulse.quantity == "velocity":
                along = (history.impulse(dt * (steps + 1)) - history.impulse(dt * steps)) / dt
            else:
                along = history.impulse(dt * (steps + 0.5))
            found[:, walls.index(wall)] += np.outer(along, direction)
        return found

    return velocity


def variation(velocity: np.ndarray) -> float:
    """Return the total variation of the velocities of walls [n, walls, d], m/s."""
    still = np.zeros_like(velocity[:1])
    steps = np.diff(velocity, axis=0, prepend=still, append=still)
    return float(np.sqrt((steps**2).sum(axis=(1, 2))).sum())


def motion_of_walls(state: State, shake: np.ndarray, dt: float) -> np.ndarray:
    """Return displacement and velocity of walls before each step and after the last
    [steps + 1, 2, freedoms (1 + walls)], from their velocities `shake`, after a block of zeros."""
    (steps, walls, dim), f = shake.shape, state.u.shape[1]
    found = np.zeros((steps + 1, 2, 1 + walls, f))
    found[0, :, 1:] = state.u[-walls:], state.v[-walls:]
    found[1:, 1, 1:, :dim] = shake
    found[1:, 0, 1:, :dim] = dt * shake
    found[:, 0] = found[:, 0].cumsum(axis=0)
    return found.reshape(steps + 1, 2, -1)
