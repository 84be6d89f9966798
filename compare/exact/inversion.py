"""Motion over time from a transfer function H(omega), by FFT with an exponential window.

With F the transform of the pulse f, and any path from 0 to infinity on which F H is analytic,

    u(t) = (1/pi) Re int F(omega) H(omega) e^{-i omega t} d omega

The path runs at the height i decay, in bins of 2 pi / window (Wilcox, Int. J. Elect. Eng. Educ. 15,
1978; Kausel & Roesset, JEM 118, 1992). A causal H is real on the imaginary axis, so the path can
begin there without a contribution, and one point in the middle of each bin is the midpoint rule on
an infinite interval. With evanescent waves H jumps at Re(omega) = 0, its response begins before its
cause and decays as a power of time, and between joints it has poles near the imaginary axis. The
path then climbs from 0 along a slope with its own Gauss points, and GAUSS points per bin avoid
wrapping of the tails; one FFT per point sums over all bins.

Motion after the window is reduced by the factor WRAPPED; frequencies end at pi / step, tapered by
exp(-36 (omega step / pi)^8). The difference from a coarser inversion, with half of the window and
every second sample of the pulse, bounds the error of both.
"""

from collections.abc import Callable
from math import isqrt
from typing import NamedTuple

import numpy as np

from jointwave.compare.exact.linear import gauss

WRAPPED = 1e-11
STEPS = 4096  # least number of fine steps in the requested duration
GAUSS = 10  # points per bin
SLOPE = 16  # bins over which the path climbs
CLIMB = 160  # points on the slope

Function = Callable[[np.ndarray], np.ndarray]


class Window(NamedTuple):
    """Fine times (s) of a whole window, their step (s), steps per sample and the decay (1/s). Each
    bin of 2 pi / window has one frequency omega (rad/s), at the fraction `node` of the bin."""

    times: np.ndarray
    step: float
    stride: int
    decay: float

    @property
    def bin_width(self) -> float:
        """Width of a bin, 2 pi / window, rad/s."""
        return 2 * np.pi / (len(self.times) * self.step)

    def omega(self, node: float, skip: int = 1) -> np.ndarray:
        """Return the frequencies [k] for every `skip`-th time."""
        count = -(-len(self.times) // skip) // 2
        return self.bin_width * (np.arange(count) + node) + 1j * self.decay

    def transform(self, signal: np.ndarray, node: float, skip: int = 1) -> np.ndarray:
        """Return F(omega) [k] of a signal given at every `skip`-th time."""
        from scipy.fft import ifft  # twice as fast as numpy's for many rows

        turn = self._turn(node)[::skip]
        return skip * self.step * len(signal) * ifft(signal * turn)[: len(signal) // 2]

    def motion(self, spectrum: np.ndarray, node: float, keep: slice) -> np.ndarray:
        """Return (1/pi) int F H e^{-i omega t} d omega along the level path, [..., n] at the times
        `keep`, from F H [..., k]."""
        from scipy.fft import fft

        found = fft(spectrum, n=len(self.times))[..., keep]
        return self.bin_width / np.pi * found / self._turn(node)[keep]

    def _turn(self, node: float) -> np.ndarray:
        t = self.times - self.times[0]
        return np.exp((1j * self.bin_width * node - self.decay) * t)


def window_of(start: float, step: float, stride: int, least: float, wrapped: float) -> Window:
    """Return the window of at least `least` fine steps, which reduces later motion by `wrapped`."""
    from scipy.fft import next_fast_len

    count = 4 * next_fast_len(int(np.ceil(least / 4)))
    decay = -np.log(wrapped) / (count * step)
    return Window(start + step * np.arange(count), step, stride, float(decay))


def taper(omega: np.ndarray, step: float) -> np.ndarray:
    """Return the filter of order 8 that is 1e-16 at the highest frequency of a step (s)."""
    return np.exp(-36 * np.minimum(omega.real * step / np.pi, 1.5) ** 8)


class Accuracy(NamedTuple):
    """Parameters of an inversion: window over duration; stride through the pulse's samples;
    fraction of the spectrum's maximum below which high frequencies are omitted."""

    window: int
    skip: int = 1
    least: float = 0.0


#: For fields at many places; for solutions; and a coarser one to bound the error of solutions.
QUICK, FINE, ROUGH = Accuracy(4, least=1e-9), Accuracy(4), Accuracy(2, skip=2)


def inverse(
    transfer: Function, pulse: Function, times: np.ndarray, causal: bool, how: Accuracy
) -> np.ndarray:
    """Return (1/pi) int F H e^{-i omega t} d omega [..., n] at `times` (s, equally spaced); its
    real part is u.

    transfer : H [..., k] at complex omega [k] (rad/s). pulse : f, zero before the first time.
    """
    n, skip = len(times), how.skip
    stride = -(-STEPS // n)
    step = (times[-1] - times[0]) / (n - 1) / stride
    window = window_of(times[0], step, stride, how.window * stride * n, WRAPPED)
    signal = pulse(window.times)[::skip]
    keep = slice(0, n * stride, stride)
    if causal:
        return _level_integral(transfer, signal, window, how, 0.5, 0, keep)
    bins = (
        weight * _level_integral(transfer, signal, window, how, node, SLOPE, keep)
        for node, weight in zip(*gauss(1.0, GAUSS), strict=True)
    )
    return sum(bins) + _slope_integral(transfer, signal, window, skip, keep)


def _level_integral(
    transfer, signal, window: Window, how: Accuracy, node: float, first: int, keep: slice
) -> np.ndarray:
    """Return the integral along the level path from bin `first` on, with one point per bin, up to
    the frequency above which the spectrum is below `least` of its maximum."""
    omega = window.omega(node, how.skip)
    F = window.transform(signal, node, how.skip) * taper(omega, how.skip * window.step)
    size = np.abs(F)
    last = max(int(np.flatnonzero(size >= how.least * size.max())[-1]), first) + 1
    spectrum = transfer(omega[first:last]) * F[first:last]
    padded = np.concatenate([np.zeros((*spectrum.shape[:-1], first)), spectrum], axis=-1)
    return window.motion(padded, node, keep)


def _slope_integral(transfer, signal, window: Window, skip: int, keep: slice) -> np.ndarray:
    """Return the integral along the slope from 0 to the level path, at the fine steps `keep`."""
    nodes, weights = gauss(1.0, CLIMB)
    end = SLOPE * window.bin_width + 1j * window.decay
    turn = 1j * end * nodes * window.step
    long, short = _powers(turn * skip, len(signal))
    rows = np.pad(signal, (0, len(long) * len(short) - len(signal))).reshape(len(long), -1)
    F = np.sum(rows @ short * long, axis=0) * (skip * window.step)
    spectrum = transfer(end * nodes) * (F * weights * end)
    long, short = _powers(-turn, keep.stop)
    found = (spectrum[..., None, :] * long) @ short.T
    return found.reshape(*spectrum.shape[:-1], -1)[..., keep] / np.pi


def _powers(x: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return e^(x m j) and e^(x k), j, k < m [m, x]: their products are e^(x n) for all n up to
    `count`, at a fraction of the cost of all exponentials."""
    n = np.arange(isqrt(count) + 1)[:, None]
    return np.exp(len(n) * n * x), np.exp(n * x)
