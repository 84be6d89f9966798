"""The motion in time of a transfer function H(omega), by FFT with an exponential window.

With F the transform of the pulse f, along any path from 0 to infinity on which F H is analytic,

    u(t) = (1/pi) Re int F(omega) H(omega) e^{-i omega t} d omega

Here it runs at the height i decay, in bins of 2 pi / window (Wilcox, Int. J. Elect. Eng. Educ. 15,
1978; Kausel & Roesset, JEM 118, 1992). A causal H is real on the imaginary axis, where the path can
begin without a contribution of its own, and one point in the middle of each bin is the midpoint
rule on an infinite interval. Where waves are evanescent H jumps at Re(omega) = 0, its response
begins before its cause and decays as a power of time, and between joints it has poles near the
imaginary axis. There the path climbs from 0 on a slope with Gauss points of its own, and GAUSS
points in each bin avoid wrapping of the tails; one FFT per point sums over all bins.

Motion after the window is reduced by the factor WRAPPED; frequencies end at pi / step, tapered by
exp(-36 (omega step / pi)^8). A coarser inversion, with half of the window and every second sample
of the pulse, has a larger error: the difference of the two bounds it.
"""

from collections.abc import Callable
from math import isqrt
from typing import NamedTuple

import numpy as np

from jointwave.compare.exact.linear import gauss

WRAPPED = 1e-11
STEPS = 4096  # least number in the requested duration
GAUSS = 10  # points per bin
SLOPE = 16  # bins over which the path climbs
CLIMB = 160  # points on the slope

Function = Callable[[np.ndarray], np.ndarray]


class Window(NamedTuple):
    """Fine times (s) of a whole window, their step (s), steps per sample and the decay (1/s)."""

    times: np.ndarray
    step: float
    stride: int
    decay: float

    @property
    def bin_width(self) -> float:
        """Return 2 pi / window, rad/s."""
        return 2 * np.pi / (len(self.times) * self.step)


class Accuracy(NamedTuple):
    """How an inversion is done: its window over the duration, every which sample of the pulse it
    takes, and the part of the pulse's spectrum below which frequencies are left out."""

    window: int
    skip: int = 1
    least: float = 0.0


#: That of fields at many places; that of solutions, and a coarser one whose difference bounds it.
QUICK, FINE, ROUGH = Accuracy(4, least=1e-9), Accuracy(4), Accuracy(2, skip=2)


def inverse(
    transfer: Function, pulse: Function, times: np.ndarray, causal: bool, how: Accuracy
) -> np.ndarray:
    """Return (1/pi) int F H e^{-i omega t} d omega [..., n] at `times` (s, equally spaced), whose
    real part is u.

    transfer : H [..., k] at complex omega [k] (rad/s). pulse : f, which no arrival precedes, taken
    as zero before the first of the times.
    """
    window, skip, least = window_of(times, how.window), how.skip, how.least
    signal = pulse(window.times)[::skip]
    keep = slice(0, len(times) * window.stride, window.stride)
    if causal:
        return _level(transfer, signal, window, skip, 0.5, 0, least)[..., keep]
    bins = (
        weight * _level(transfer, signal, window, skip, node, SLOPE, least)[..., keep]
        for node, weight in zip(*gauss(1.0, GAUSS), strict=True)
    )
    return sum(bins) + _climb(transfer, signal, window, skip, keep)


def window_of(times: np.ndarray, size: float) -> Window:
    """Return the window of `size` times the duration."""
    from scipy.fft import next_fast_len

    n = len(times)
    stride = -(-STEPS // n)
    step = (times[-1] - times[0]) / (n - 1) / stride
    count = 4 * next_fast_len(int(np.ceil(size * stride * n / 4)))
    decay = -np.log(WRAPPED) / (count * step)
    return Window(times[0] + step * np.arange(count), step, stride, float(decay))


def _level(
    transfer, signal, window: Window, skip: int, node: float, first: int, least: float
) -> np.ndarray:
    """Return the integral over the level path from bin `first` on, with one point per bin, up to
    the frequency above which the spectrum is below `least` of its maximum."""
    from scipy.fft import fft, ifft  # of many rows in half of numpy's time

    t, step = window.times - window.times[0], skip * window.step
    width = window.bin_width
    omega = width * (np.arange(len(signal) // 2) + node) + 1j * window.decay
    turn = np.exp(1j * omega[0] * t)
    F = step * len(signal) * ifft(signal * turn[::skip])[: len(omega)]
    F *= np.exp(-36 * (omega.real * step / np.pi) ** 8)
    size = np.abs(F)
    last = max(int(np.flatnonzero(size >= least * size.max())[-1]), first) + 1
    omega, F = omega[:last], F[:last]
    spectrum = transfer(omega[first:]) * F[first:]
    padded = np.concatenate([np.zeros((*spectrum.shape[:-1], first)), spectrum], axis=-1)
    return width / np.pi * fft(padded, n=len(t)) / turn


def _climb(transfer, signal, window: Window, skip: int, keep: slice) -> np.ndarray:
    """Return the integral over the slope from 0 to the level path, at the fine steps `keep`."""
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
    `count`, whose own exponentials would take most of the time."""
    n = np.arange(isqrt(count) + 1)[:, None]
    return np.exp(len(n) * n * x), np.exp(n * x)
