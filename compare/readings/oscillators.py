"""Largest displacements of oscillators on moving ground, by the exact response.

The acceleration of the ground is straight lines between its samples (Nigam & Jennings, Bull. Seism.
Soc. Am. 59, 1969). With l = omega (-zeta + i sqrt(1 - zeta^2)) and w = x' - conj(l) x, so that
x = Im w / Im l, an oscillator x'' + 2 zeta omega x' + omega^2 x = -(a + b s) is w' = l w - a - b s:

    w(s) = (w(0) - p) exp(l s) + p + q s,    q = b / l,    p = (a + q) / l.

In an interval x is a straight line and a decaying oscillation: the largest |x| lies in its first or
last period. There it is looked for at 1024 points a period, low by at most (2 pi / 1024)^2 / 8 =
5e-6 of the oscillation. After the record its first extreme is the largest.
"""

from math import ceil, pi, sqrt

import numpy as np

POINTS = 1024  # a period


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
        for at in start + np.linspace(0, part, count + 1):
            x = np.abs((turning * np.exp(rate * at) + p + q * at).imag).max(axis=-1)
            largest = np.maximum(largest, x)
    return largest / rate.imag
