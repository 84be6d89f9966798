"""A wave at one joint, linear or one that slips: what passes and what returns."""

from math import asin, cos, pi, sin, sqrt

import numpy as np


def coefficients(
    omega: np.ndarray | float, stiffness: float, impedance: float, viscosity: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the complex T and R of stress at omega (rad/s). stiffness K in Pa/m, impedance Z in Pa
    s/m, viscosity c_j = K eta in Pa s/m."""
    omega = np.asarray(omega)
    transmitted = 1 / (1 + 1j * omega * impedance / (2 * (stiffness + 1j * omega * viscosity)))
    return transmitted, transmitted - 1


def relaxed_sine(times: np.ndarray, omega: float, end: float, tau: float) -> np.ndarray:
    """Return s of tau s' + s = sin(omega t), 0 <= t <= end, 0 else, from rest at times (s): what
    passes a joint with tau = Z / 2K, s."""
    x = np.clip(times, 0, end)
    s = np.sin(omega * x) - omega * tau * (np.cos(omega * x) - np.exp(-x / tau))
    return s * np.exp(-np.maximum(times - end, 0) / tau) / (1 + (omega * tau) ** 2)


def slip_coefficients(a: float) -> tuple[float, float, float]:
    """Return T, R and A of a harmonic wave at a joint rigid before slip, a = tau / (Z V) <= 1.

    Root mean squares of the transmitted and reflected stress over that of the incident one, and
    A^2 = 1 - T^2 - R^2, the share of the energy that goes into friction. With s = asin a

        T^2 = (2/pi)(s - a sqrt(1 - a^2) + a^2 (pi - 2 s))
        R^2 = (4/pi)((pi/2 - s)/2 + sin(2 s)/4 - 2 a cos s + a^2 (pi/2 - s))"""
    s = asin(a)
    T2 = 2 / pi * (s - a * sqrt(1 - a**2) + a**2 * (pi - 2 * s))
    R2 = 4 / pi * ((pi / 2 - s) / 2 + sin(2 * s) / 4 - 2 * a * cos(s) + a**2 * (pi / 2 - s))
    return sqrt(T2), sqrt(max(R2, 0.0)), sqrt(max(1 - T2 - R2, 0.0))
