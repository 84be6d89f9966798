"""Load histories: value, rate, time integrals, and the times of their kinks.

All are closed forms. Units are those of an end stress, Pa and Pa s; a force or a motion has its own
units instead.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Any, NamedTuple

import numpy as np


class Forms(NamedTuple):
    """A smooth function of time, its rate, its integral, and its double integral."""

    rate: Callable[[Any], Any]
    value: Callable[[Any], Any]
    integral: Callable[[Any], Any]
    twice: Callable[[Any], Any]


class LoadHistory(ABC):
    """A load over time, zero before t = 0."""

    stop = inf  #: s, zero after it

    @property
    def end(self) -> float:
        """Time after which the load is zero, constant or hardly changes, s."""
        return 0.0

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0, self.stop] if self.stop < inf else [0.0]

    @abstractmethod
    def integral(self, n: int, t: np.ndarray) -> np.ndarray:
        """Return the n-th integral of the stress from minus infinity to t; n = -1: its rate."""

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        return self.integral(0, t)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s)."""
        return self.integral(-1, t)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        return self.integral(1, t)

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        return self.integral(2, t)


class Smooth(LoadHistory):
    """A load of smooth `forms` from t = 0 to `stop`."""

    @property
    @abstractmethod
    def forms(self) -> Forms:
        """The smooth function of the load, and its integrals."""

    def integral(self, n, t):
        rate, value, once, twice = self.forms
        if n < 1:
            return np.where((t > 0) & (t < self.stop), (value if n == 0 else rate)(t), 0.0)
        inside = np.clip(t, 0.0, self.stop)
        if n == 1:
            return np.where(t > 0, once(inside) - once(0.0), 0.0)
        found = twice(inside) - twice(0.0) - once(0.0) * inside
        if self.stop < inf:
            found += self.impulse(np.array(self.stop)) * np.maximum(t - self.stop, 0.0)
        return np.where(t > 0, found, 0.0)


@dataclass(frozen=True)
class Sine(Smooth):
    """Cycles of p0 sin(2 pi t / T), zero elsewhere (Guo & Li 2002, fig. 2); 0.5: a half sine."""

    amplitude: float
    period: float
    cycles: float = 1

    @property
    def forms(self):
        A, w = self.amplitude, 2 * pi / self.period
        return Forms(
            lambda t: A * w * np.cos(w * t),
            lambda t: A * np.sin(w * t),
            lambda t: A * (1 - np.cos(w * t)) / w,
            lambda t: A / w * (t - np.sin(w * t) / w),
        )

    @property
    def end(self):
        return self.cycles * self.period

    stop = end


@dataclass(frozen=True)
class Ricker(Smooth):
    """p0 (1 - 2 a) exp(-a), a = (pi (t - 1.5 T) / T)^2: a Ricker wavelet of peak frequency 1 / T.
    Its centre is 1.5 T; before t = 0 and after `end` it is below 1e-8 of the peak."""

    amplitude: float
    period: float

    @property
    def centre(self) -> float:
        """Time of the peak, s."""
        return 1.5 * self.period

    @property
    def end(self):
        return 2 * self.centre

    @property
    def forms(self):
        A, w, c = self.amplitude, (pi / self.period) ** 2, self.centre

        def wave(polynomial):
            return lambda t: A * polynomial(t - c) * np.exp(-w * (t - c) ** 2)

        return Forms(
            wave(lambda s: 2 * w * s * (2 * w * s**2 - 3)),
            wave(lambda s: 1 - 2 * w * s**2),
            wave(lambda s: s),
            wave(lambda s: -1 / (2 * w)),
        )


@dataclass(frozen=True)
class Gabor(Smooth):
    """p0 exp(-s^2 / 2 b^2) cos(2 pi s / T), s = t - 6.4 b: a cosine in a Gaussian of standard
    deviation b = cycles T / 4, which contains the cycles within two b on each side (Gabor 1946).

    Before t = 0 and after `end` it is below 2e-9 of the peak. With a = 2 pi b / (T sqrt(2)), x = s
    / (b sqrt(2)) and Faddeeva's function w, the integral from the peak to s is p0 b sqrt(pi / 2) Re
    erf(x - i a) exp(-a^2), and erf(z) = 1 - exp(-z^2) w(i z).
    """

    amplitude: float
    period: float
    cycles: int = 1

    @property
    def width(self) -> float:
        """Standard deviation b of the envelope, s."""
        return self.cycles * self.period / 4

    @property
    def centre(self) -> float:
        """Time of the peak, s."""
        return 6.4 * self.width

    @property
    def end(self):
        return 2 * self.centre

    @property
    def forms(self):
        A, b, c, w = self.amplitude, self.width, self.centre, 2 * pi / self.period

        def envelope(t):
            return np.exp(-((t - c) ** 2) / (2 * b**2) + 1j * w * (t - c))

        def scaled(t):
            """Return z = x - i a, and exp(-a^2) erf(z)."""
            from scipy.special import wofz

            a = b * w / sqrt(2)
            z = (t - c) / (sqrt(2) * b) - 1j * a
            return z, np.exp(-(a**2)) - envelope(t) * wofz(1j * z)

        def twice(t):
            z, error = scaled(t)
            return A * b**2 * (sqrt(pi) * z * error + envelope(t)).real

        return Forms(
            lambda t: A * ((1j * w - (t - c) / b**2) * envelope(t)).real,
            lambda t: A * envelope(t).real,
            lambda t: A * b * sqrt(pi / 2) * scaled(t)[1].real,
            twice,
        )


@dataclass(frozen=True)
class Step(Smooth):
    """A stress p0 applied at t = 0 and held; half of it at t = 0."""

    amplitude: float

    @property
    def forms(self):
        A = self.amplitude
        return Forms(
            np.zeros_like,
            lambda t: A * np.heaviside(t, 0.5),
            lambda t: A * t,
            lambda t: A * t**2 / 2,
        )

    def integral(self, n, t):
        return self.forms.value(t) if n == 0 else super().integral(n, t)


@dataclass(frozen=True)
class Recorded(LoadHistory):
    """A piecewise linear history, zero outside its samples: a record, or a triangle.

    `stress` is [n] Pa at `time` [n] s; `timed` : whether a file gives the unit of its times.
    Integrals are exact: a step of any length takes the true mean. The rate at a sample is the slope
    before it.
    """

    time: np.ndarray
    stress: np.ndarray
    timed: bool = True

    def integral(self, n, t):
        slopes, last = np.diff(self.stress) / np.diff(self.time), self.time[-1]
        if n < 0:
            return np.concatenate([[0.0], slopes, [0.0]])[np.searchsorted(self.time, t)]
        if n == 0:
            return np.interp(np.asarray(t, dtype=float), self.time, self.stress, 0.0, 0.0)
        from scipy.interpolate import PPoly  # slow to import

        lines = PPoly([slopes, self.stress[:-1]], self.time)
        found = lines.antiderivative(n)(np.clip(t, self.time[0], last))
        return found + self.impulse(last) * np.maximum(t - last, 0.0) if n == 2 else found

    @property
    def end(self):
        return float(self.time[-1])

    @property
    def breaks(self):
        return self.time.tolist()


@dataclass(frozen=True)
class Integrated(LoadHistory):
    """The time integral of a history, such as the velocity (m/s) of an acceleration."""

    history: LoadHistory

    def integral(self, n, t):
        return self.history.integral(n + 1, t)

    @property
    def end(self):
        return self.history.end

    @property
    def breaks(self):
        return self.history.breaks


@dataclass(frozen=True)
class Late(LoadHistory):
    """A history delayed by a time in s."""

    history: LoadHistory
    by: float

    def integral(self, n, t):
        return self.history.integral(n, np.subtract(t, self.by))

    @property
    def end(self):
        return self.history.end + self.by

    @property
    def breaks(self):
        return [one + self.by for one in self.history.breaks]


def triangle(amplitude: float, rise: float, decay: float) -> Recorded:
    """Return a triangular pulse, as blasts are idealised: linear rise in `rise` (s; 0:
    instantaneous), linear fall in `decay` (s)."""
    time, stress = np.array([0.0, rise, rise + decay]), amplitude * np.array([0.0, 1.0, 0.0])
    return Recorded(time, stress) if rise else Recorded(time[1:], stress[1:])


def periodic(
    shape: str, amplitude: float, period: float, cycles: int | None
) -> Sine | Ricker | Gabor:
    """Return a pulse with a period (s): "sine", "half-sine", "ricker" or "gabor"."""
    if shape == "ricker":
        return Ricker(amplitude, period)
    if shape == "gabor":
        return Gabor(amplitude, period, cycles or 1)
    return Sine(amplitude, period, 0.5 if shape == "half-sine" else cycles or 1)
