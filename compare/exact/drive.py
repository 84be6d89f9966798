"""The excitation of a scene's start: its end stress, or the velocity of its base."""

from typing import Protocol

import numpy as np

from cases.loads import load_history, velocity_of
from cases.schema.scene import Scene


class Signal(Protocol):
    """A function of time that is smooth between its breaks (s)."""

    @property
    def breaks(self) -> list[float]:
        """Times at which it is not smooth, s."""

    @property
    def end(self) -> float:
        """Time after which it is practically constant, s."""

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return its value at times t (s)."""


def drive(scene: Scene) -> Signal:
    """Return the end stress (Pa) or, where the load is a motion, the base's velocity (m/s)."""
    load = scene.load
    if scene.shakes_base:
        return velocity_of(load, load.amplitude / load.scale)
    return load_history(scene)
