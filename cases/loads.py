"""The load over time: its value, its time integral, and where it is not smooth.

All three are exact, so an engine can apply the mean of the load over each of its steps and a
reference can integrate between breakpoints. Units are those of an end stress, Pa and Pa s; the
motion of a shaken base has m/s and m, or m/s2 and m/s, in their place.
"""

from dataclasses import dataclass
from math import pi
from typing import Protocol

import numpy as np

from cases.sampling import Interpolation
from cases.schema.pulse import Pulse
from cases.schema.scene import Scene


@dataclass(frozen=True)
class Sine:
    """Whole cycles of p0 sin(2 pi t / T), zero before and after (Guo & Li 2002, fig. 2)."""

    amplitude: float
    period: float
    cycles: int = 1

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        inside = (t > 0) & (t < self.end)
        return np.where(inside, self.amplitude * np.sin(2 * pi * t / self.period), 0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        w = 2 * pi / self.period
        return self.amplitude * (1 - np.cos(w * np.clip(t, 0, self.end))) / w

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s)."""
        inside, w = (t > 0) & (t < self.end), 2 * pi / self.period
        return np.where(inside, self.amplitude * w * np.cos(w * t), 0.0)

    @property
    def end(self) -> float:
        """Time at which the last cycle ends, s."""
        return self.cycles * self.period

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0, self.end]


@dataclass(frozen=True)
class Ricker:
    """p0 (1 - 2 a) exp(-a), a = (pi (t - 1.5 T) / T)^2: a Ricker wavelet of peak frequency 1 / T.

    Centred at 1.5 T, where the part before t = 0 is below 1e-8 of the peak.
    """

    amplitude: float
    period: float

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        a = (pi * (t - 1.5 * self.period) / self.period) ** 2
        return np.where(t > 0, self.amplitude * (1 - 2 * a) * np.exp(-a), 0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        return self._integral(np.maximum(t, 0.0)) - self._integral(0.0)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s)."""
        s, w = t - 1.5 * self.period, (pi / self.period) ** 2
        a = w * s**2
        return np.where(t > 0, 2 * self.amplitude * w * s * (2 * a - 3) * np.exp(-a), 0.0)

    def _integral(self, t):
        s = t - 1.5 * self.period
        return self.amplitude * s * np.exp(-((pi * s / self.period) ** 2))

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0]


@dataclass(frozen=True)
class Step:
    """A stress p0 that is applied at t = 0 and stays."""

    amplitude: float

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s); half the step at t = 0."""
        return self.amplitude * np.heaviside(t, 0.5)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        return self.amplitude * np.maximum(t, 0.0)

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0]


@dataclass(frozen=True)
class Recorded:
    """A piecewise linear history, zero outside its samples.

    `stress` is [n] Pa at `time` [n] s. Its running integral is exact, so a step of any length
    takes the true mean of the history and nothing is lost to undersampling.
    """

    time: np.ndarray
    stress: np.ndarray

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        return np.interp(t, self.time, self.stress, left=0.0, right=0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        areas = np.diff(self.time) * (self.stress[1:] + self.stress[:-1]) / 2
        running = np.concatenate([[0.0], np.cumsum(areas)])
        t = np.clip(t, self.time[0], self.time[-1])
        i = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        s = t - self.time[i]
        slope = (self.stress[i + 1] - self.stress[i]) / (self.time[i + 1] - self.time[i])
        return running[i] + s * (self.stress[i] + slope * s / 2)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s), that of the line to the left."""
        slopes = np.concatenate([[0.0], np.diff(self.stress) / np.diff(self.time), [0.0]])
        return slopes[np.searchsorted(self.time, t)]

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return self.time.tolist()


LoadHistory = Sine | Ricker | Step | Recorded


class Integral(Protocol):
    """A load by its integral over time."""

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""


def load_history(scene: Scene) -> LoadHistory:
    """Return the scene's load as a function of time: its end stress or the motion of its base.

    Stress is positive in compression. Without a load the stress is zero. Of an extreme load it is
    that over `scene.load.scale`, which a result is multiplied by when it is put together.
    """
    return history_of(scene.load, scene.load.amplitude / scene.load.scale)


def history_of(pulse: Pulse, amplitude: float) -> LoadHistory:
    """Return a pulse of this amplitude as a function of time."""
    if pulse.shape == "step":
        return Step(amplitude)
    if pulse.shape == "table":
        assert pulse.history is not None
        return Recorded(pulse.history.time, amplitude * pulse.history.stress)
    assert pulse.period is not None
    if pulse.shape == "ricker":
        return Ricker(amplitude, pulse.period)
    return Sine(amplitude, pulse.period, pulse.cycles or 1)


def step_means(load: Integral, dt: float, count: int) -> np.ndarray:
    """Return the mean stress over [(n - 1/2) dt, (n + 1/2) dt] for n = 0 .. count - 1, Pa.

    This is the load that makes leapfrog exact for the bar at c dt = d: the momentum that enters
    between two half steps is the true one.
    """
    edges = dt * (np.arange(count + 1) - 0.5)
    return np.diff(load.impulse(edges)) / dt


def with_load_itself(
    stress: np.ndarray, scene: Scene, sections: Interpolation, times: np.ndarray, dt: float
) -> np.ndarray:
    """Return stresses (Pa) that hold the load itself where steps of dt (s) took its mean.

    stress : float array [section, time] along y, or [section, axis, time]. sections : between
    contacts, of which 0 is the loaded face.
    """
    faced = np.flatnonzero((sections.left == 0) & (sections.weight < 1.0))
    if not faced.size or scene.load.shakes_base or scene.load.arm is not None:
        return stress
    load, found = load_history(scene), stress.copy()
    mean = (load.impulse(times + dt / 2) - load.impulse(times - dt / 2)) / dt
    axes = scene.load.direction[1] if stress.ndim == 2 else np.array(scene.load.direction)
    beside = np.multiply.outer(axes, load.value(times) - mean)
    found[faced] += np.multiply.outer(1.0 - sections.weight[faced], beside)
    return found


def base_steps(scene: Scene, dt: float, count: int) -> np.ndarray:
    """Return how far a shaken base moves in each step [n dt, (n + 1) dt], n = 0 .. count - 1, m.

    A velocity history is integrated exactly over the step. An acceleration history gives, as
    leapfrog does, dt times the velocity at the half step. Zero for a base that is not shaken.
    """
    return _base_steps(load_history(scene), scene.load.quantity, dt, count)


def base_motion(pulse: Pulse, dt: float, count: int) -> np.ndarray:
    """Return the same of any pulse that shakes a base."""
    return _base_steps(history_of(pulse, pulse.amplitude), pulse.quantity, dt, count)


def _base_steps(load: LoadHistory, quantity: str, dt: float, count: int) -> np.ndarray:
    if quantity == "velocity":
        return np.diff(load.impulse(dt * np.arange(count + 1)))
    if quantity == "acceleration":
        return dt * load.impulse(dt * (np.arange(count) + 0.5))
    return np.zeros(count)
