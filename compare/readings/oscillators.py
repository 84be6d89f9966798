"""Largest displacements of oscillators on moving ground, by the exact response.

The acceleration of the ground is straight lines between its samples (Nigam & Jennings, Bull. Seism.
Soc. Am. 59, 1969). With l = omega (-zeta + i sqrt(1 - zeta^2)) and w = x' - conj(l) x, so that
x = Im w / Im l, an oscillator x'' + 2 zeta omega x' + omega^2 x = -(a + b s) is w' = l w - a - b s:

    w(s) = (w(0) - p) exp(l s) + p + q s,    q = b / l,    p = (a + q) / l.

In an interval x is a straight line and a decaying oscillation, whose maxima a period apart are a
convex sequence: the largest |x| lies in the first or the last period. There x' is expanded to
second order about points 1/16 of a period apart, and x evaluated at the root, so that nothing is
overestimated. An extreme is at most the phase e = pi / 16 from a point; the third order leaves the
root off by e^3 / 6, and (e^3 / 6)^2 / 2 = 8e-7 of the oscillation is missed; with 70 % damping, by
which curvature is lost at an extreme, 4e-5.
"""

from math import ceil, pi, sqrt

import numpy as np

POINTS = 16  # a period


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
    after = lfilter([1.0], [1.0, -decay], p * (1 - decay) + q * dt)
    before = np.concatenate([np.zeros_like(after[..., :1]), after[..., :-1]], axis=-1)
    during = _largest(before - p, p, q, rate, dt)
    none = np.zeros_like(after[..., -1:])
    free = _largest(after[..., -1:], none, none, rate, 2 * pi / rate.imag)
    return np.maximum(during, free) / rate.imag


def _largest(turning: np.ndarray, p: np.ndarray, q: np.ndarray, rate: complex, dt: float):
    """Return the largest |Im(turning exp(rate s) + p + q s)|, 0 <= s <= dt, over the last axis."""
    shape, n = turning.shape[:-1], turning.shape[-1]
    turning, p, q = (x.reshape(-1, n) for x in (turning, p, q))
    period, largest = 2 * pi / rate.imag, np.zeros(len(turning))
    h = min(dt, 2 * pi / abs(rate) / POINTS)
    points = np.linspace(0, dt, ceil(dt / h) + 1)
    if dt > 2 * period:
        first = np.linspace(0, period, ceil(period / h) + 1)
        points = np.concatenate([first, dt - period + first])
    for s in points:
        here = turning * np.exp(rate * s)
        x, bend = (here + p + q * s).imag, (rate**2 * here).imag
        largest = np.maximum(largest, np.abs(x).max(axis=-1))
        # What an extreme half a step away can add; only such points are followed.
        more = 1.2 * np.abs(bend).max(axis=-1) * h**2 / 8
        row, i = np.nonzero(np.abs(x) >= (largest - more)[:, None])
        here = here[row, i]
        slope, bend, jerk = (here * rate**k + q[row, i] * (k == 1) for k in (1, 2, 3))
        slope, bend, jerk = slope.imag, bend.imag, jerk.imag
        root = np.sqrt(np.maximum(bend**2 - 2 * slope * jerk, 0.0))
        step = np.clip(_ratio(-2 * slope, bend + np.copysign(root, bend), h), -s, dt - s)
        found = here * np.exp(rate * step) + p[row, i] + q[row, i] * (s + step)
        np.maximum.at(largest, row, np.abs(found.imag))
    return largest.reshape(shape)


def _ratio(one: np.ndarray, other: np.ndarray, most: float) -> np.ndarray:
    """Return one / other between -most and most, and 0 beyond."""
    within = np.abs(one) < most * np.abs(other)
    return np.divide(one, other, out=np.zeros_like(one), where=within)
