"""Largest displacements of oscillators on moving ground, by the exact response.

The acceleration of the ground is straight lines between its samples (Nigam & Jennings, Bull. Seism.
Soc. Am. 59, 1969). With l = omega (-zeta + i sqrt(1 - zeta^2)) and w = x' - conj(l) x, so that
x = Im w / Im l, an oscillator x'' + 2 zeta omega x' + omega^2 x = -(a + b s) is w' = l w - a - b s:

    w(s) = (w(0) - p) exp(l s) + p + q s,    q = b / l,    p = (a + q) / l.

In an interval x is a straight line and a decaying oscillation: the largest |x| lies in its first or
last period. There it is that of cubics with the values and slopes at 32 points a period, off by
(2 pi / 32)^4 / 384 = 4e-6 of the oscillation. After the record its first extreme is the largest.
"""

from math import ceil, pi, sqrt

import numpy as np

POINTS = 32  # a period


def largest_displacement(ground: np.ndarray, dt: float, omega: float, damping: float) -> np.ndarray:
    """Return max |x| of an oscillator at rest until the ground moves [...], m, also after it.

    ground : [..., n] its acceleration, m/s2, dt (s) apart, zero after the last. omega : rad/s.
    damping : of the critical one, below 1.
    """
    from scipy.signal import lfilter

    rate = omega * complex(-damping, sqrt(1 - damping**2))
    q = np.diff(ground) / dt / rate
    p = (ground[..., :-1] + q) / rate
    decay = np.exp(rate * dt)
    w = lfilter([1.0], [1.0, -decay], p * (1 - decay) + q * dt)
    turning = np.concatenate([np.zeros_like(w[..., :1]), w[..., :-1]], axis=-1) - p
    part = min(dt, 2 * pi / rate.imag)
    count = ceil(POINTS * part * omega / (2 * pi))
    extreme, last = np.angle(-rate.conjugate()), w[..., -1]
    late = (extreme - np.angle(last)) % pi / rate.imag
    largest = np.abs(last) * np.exp(rate.real * late) * np.sin(extreme)
    for start in {0.0, dt - part}:
        points = start + np.linspace(0, part, count + 1)
        turned = (turning * np.exp(rate * s) for s in points)
        both = (
            ((here + p + q * s).imag, (rate * here + q).imag * part / count)
            for here, s in zip(turned, points, strict=True)
        )
        x, slope = next(both)
        for end, leaving in both:
            found = np.maximum(np.abs(end), _turn(x, slope, end, leaving))
            largest, x, slope = np.maximum(largest, found.max(axis=-1)), end, leaving
    return largest / rate.imag


def _turn(x: np.ndarray, slope: np.ndarray, end: np.ndarray, leaving: np.ndarray) -> np.ndarray:
    """Return |x| where the cubic through x and end, with slopes an interval, turns; 0 where not."""
    cubic, square = slope + leaving - 2 * (end - x), 3 * (end - x) - 2 * slope - leaving
    root = np.sqrt(np.maximum(square**2 - 3 * cubic * slope, 0.0))
    turns, divisor = slope * leaving < 0, np.copysign(root, slope) - square
    at = np.divide(slope, divisor, out=np.zeros_like(x), where=turns)
    return np.where(turns, np.abs(x + at * (slope + at * (square + at * cubic))), 0.0)
