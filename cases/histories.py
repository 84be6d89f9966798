"""Load histories: value, time integrals, and times where they are not smooth.

All are closed forms. Units are those of an end stress, Pa and Pa s; a force or a motion has its own
in their place.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np


@dataclass(frozen=True)
class Sine:
    """Cycles of p0 sin(2 pi t / T), zero before and after (Guo & Li 2002, fig. 2); 0.5 of one is
    a half sine."""

    amplitude: float
    period: float
    cycles: float = 1

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        inside = (t > 0) & (t < self.end)
        return np.where(inside, self.amplitude * np.sin(2 * pi * t / self.period), 0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        w = 2 * pi / self.period
        return self.amplitude * (1 - np.cos(w * np.clip(t, 0, self.end))) / w

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        w, inside = 2 * pi / self.period, np.clip(t, 0, self.end)
        found = self.amplitude / w * (inside - np.sin(w * inside) / w)
        return found + self.impulse(np.array(self.end)) * np.maximum(t - self.end, 0.0)

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

    @property
    def centre(self) -> float:
        """Time of the peak, s."""
        return 1.5 * self.period

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        a = (pi * (t - self.centre) / self.period) ** 2
        return np.where(t > 0, self.amplitude * (1 - 2 * a) * np.exp(-a), 0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        return self._integral(np.maximum(t, 0.0)) - self._integral(0.0)

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        w, later = (pi / self.period) ** 2, np.maximum(t, 0.0)
        before, at = (np.exp(-w * (x - self.centre) ** 2) for x in (0.0, later))
        return self.amplitude * (before - at) / (2 * w) - self._integral(0.0) * later

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s)."""
        s, w = t - self.centre, (pi / self.period) ** 2
        a = w * s**2
        return np.where(t > 0, 2 * self.amplitude * w * s * (2 * a - 3) * np.exp(-a), 0.0)

    def _integral(self, t):
        s = t - self.centre
        return self.amplitude * s * np.exp(-((pi * s / self.period) ** 2))

    @property
    def end(self) -> float:
        """Time after which less than 1e-8 of the peak is left, s."""
        return 3 * self.period

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0]


@dataclass(frozen=True)
class Gabor:
    """p0 exp(-s^2 / 2 b^2) cos(2 pi s / T), s = t - 6.4 b: a cosine in a Gaussian of standard
    deviation b = cycles T / 4, so that two of them to each side hold the cycles (Gabor 1946).

    The part before t = 0 is below 2e-9 of the peak. With a = 2 pi b / (T sqrt(2)), x = s / (b
    sqrt(2)) and Faddeeva's function w, the integral from the peak to s is p0 b sqrt(pi / 2)
    Re erf(x - i a) exp(-a^2), and erf(z) = 1 - exp(-z^2) w(i z).
    """

    amplitude: float
    period: float
    cycles: int = 1

    @property
    def width(self) -> float:
        """The standard deviation b of the envelope, s."""
        return self.cycles * self.period / 4

    @property
    def centre(self) -> float:
        """Time of the peak, s."""
        return 6.4 * self.width

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        return np.where(t > 0, self.amplitude * self._envelope(t - self.centre).real, 0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        found = self._integral(np.maximum(t, 0.0)) - self._integral(0.0)
        return np.where(t > 0, found, 0.0)

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        later = np.maximum(t, 0.0)
        found = self._twice(later) - self._twice(0.0) - self._integral(0.0) * later
        return np.where(t > 0, found, 0.0)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s)."""
        s = t - self.centre
        slope = (2j * pi / self.period - s / self.width**2) * self._envelope(s)
        return np.where(t > 0, self.amplitude * slope.real, 0.0)

    def _envelope(self, s):
        return np.exp(-(s**2) / (2 * self.width**2) + 2j * pi * s / self.period)

    def _scaled(self, t):
        """Return z = x - i a, and exp(-a^2) erf(z), at times t (s)."""
        from scipy.special import wofz

        s, a = t - self.centre, sqrt(2) * pi * self.width / self.period
        z = s / (sqrt(2) * self.width) - 1j * a
        return z, np.exp(-(a**2)) - self._envelope(s) * wofz(1j * z)

    def _integral(self, t):
        return self.amplitude * self.width * sqrt(pi / 2) * self._scaled(t)[1].real

    def _twice(self, t):
        z, error = self._scaled(t)
        found = sqrt(pi) * z * error + self._envelope(t - self.centre)
        return self.amplitude * self.width**2 * found.real

    @property
    def end(self) -> float:
        """Time after which less than 2e-9 of the peak is left, s."""
        return 2 * self.centre

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0]


@dataclass(frozen=True)
class Step:
    """A stress p0 applied at t = 0 and held constant."""

    amplitude: float

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s); half the step at t = 0."""
        return self.amplitude * np.heaviside(t, 0.5)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        return self.amplitude * np.maximum(t, 0.0)

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        return self.amplitude * np.maximum(t, 0.0) ** 2 / 2

    @property
    def end(self) -> float:
        """Time after which it is constant, s."""
        return 0.0

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return [0.0]


@dataclass(frozen=True)
class Recorded:
    """A piecewise linear history, zero outside its samples: a record, or a triangle.

    `stress` is [n] Pa at `time` [n] s. Its running integral is exact, so a step of any length
    takes the true mean of the history and nothing is lost to undersampling.
    """

    time: np.ndarray
    stress: np.ndarray

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the stress (Pa) at times t (s)."""
        return np.interp(np.asarray(t, dtype=float), self.time, self.stress, left=0.0, right=0.0)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the stress from minus infinity to t (Pa s)."""
        running, _ = self._sums
        i, s, slope = self._piece(t)
        return running[i] + s * (self.stress[i] + slope * s / 2)

    def double_impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the impulse from minus infinity to t (Pa s2)."""
        running, twice = self._sums
        i, s, slope = self._piece(t)
        found = twice[i] + s * (running[i] + s * (self.stress[i] / 2 + slope * s / 6))
        return found + running[-1] * np.maximum(t - self.time[-1], 0.0)

    @property
    def _sums(self) -> tuple[np.ndarray, np.ndarray]:
        """The impulse and its own integral up to each sample."""
        dt, before, after = np.diff(self.time), self.stress[:-1], self.stress[1:]
        running = np.concatenate([[0.0], np.cumsum(dt * (before + after) / 2)])
        more = dt * (running[:-1] + dt * (2 * before + after) / 6)
        return running, np.concatenate([[0.0], np.cumsum(more)])

    def _piece(self, t):
        """Return the sample before t, the time since, and the slope to the next sample."""
        t = np.clip(t, self.time[0], self.time[-1])
        i = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        slope = (self.stress[i + 1] - self.stress[i]) / (self.time[i + 1] - self.time[i])
        return i, t - self.time[i], slope

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the rate of the stress (Pa/s) at times t (s), that of the line to the left."""
        slopes = np.concatenate([[0.0], np.diff(self.stress) / np.diff(self.time), [0.0]])
        return slopes[np.searchsorted(self.time, t)]

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return float(self.time[-1])

    @property
    def breaks(self) -> list[float]:
        """Times at which the load is not smooth, s."""
        return self.time.tolist()


#: A pulse by its shape in time.
Shape = Sine | Ricker | Gabor | Step | Recorded


@dataclass(frozen=True)
class Integrated:
    """The time integral of a history: the velocity (m/s) of an acceleration."""

    history: Shape

    def value(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of the history from minus infinity to t (s)."""
        return self.history.impulse(t)

    def impulse(self, t: np.ndarray) -> np.ndarray:
        """Return the integral of that integral."""
        return self.history.double_impulse(t)

    def rate(self, t: np.ndarray) -> np.ndarray:
        """Return the history itself."""
        return self.history.value(t)

    @property
    def end(self) -> float:
        """Time after which it hardly changes, s."""
        return self.history.end

    @property
    def breaks(self) -> list[float]:
        """Times at which the history is not smooth, s."""
        return self.history.breaks


LoadHistory = Shape | Integrated


def triangle(amplitude: float, rise: float, decay: float) -> Recorded:
    """Return a triangular pulse: straight up to its peak in the time `rise` (s; 0: at once), and
    straight down in `decay` (s), as blasts are idealised."""
    time, stress = np.array([0.0, rise, rise + decay]), amplitude * np.array([0.0, 1.0, 0.0])
    return Recorded(time, stress) if rise else Recorded(time[1:], stress[1:])


def periodic(
    shape: str, amplitude: float, period: float, cycles: int | None
) -> Sine | Ricker | Gabor:
    """Return a pulse that has a period (s): "sine", "half-sine", "ricker" or "gabor"."""
    if shape == "ricker":
        return Ricker(amplitude, period)
    if shape == "gabor":
        return Gabor(amplitude, period, cycles or 1)
    return Sine(amplitude, period, 0.5 if shape == "half-sine" else cycles or 1)
