"""The excitation of a scene's start: its end stress, or the velocity of its base."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cases.loads import LoadHistory, load_history
from cases.schema.scene import Scene


class Signal(Protocol):
    """A function of time that is smooth between its breaks (s)."""

    @property
    def breaks(self) -> list[float]:
        """Times at which it is not smooth, s."""

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return its value at times t (s)."""


@dataclass(frozen=True)
class Integrated:
    """The time integral of a history."""

    history: LoadHistory

    @property
    def breaks(self) -> list[float]:
        """Times at which the history is not smooth, s."""
        return self.history.breaks

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the history from minus infinity to t (s)."""
        return self.history.impulse(t)


def drive(scene: Scene) -> Signal:
    """Return the end stress (Pa) or, where the load is a motion, the base's velocity (m/s)."""
    load = load_history(scene)
    return Integrated(load) if scene.load.quantity == "acceleration" else load
