"""The generalised-alpha method on one linear mode, exactly: what an implicit engine must reproduce.

A mode of frequency omega and damping ratio xi, q'' + 2 xi omega q' + omega^2 q = F, is stepped by

    q' = q + dt v + dt^2 ((1/2 - beta) a + beta a'),   v' = v + dt ((1 - gamma) a + gamma a'),
    (1 - alpha_m) a' + alpha_m a + (1 - alpha_f) g' + alpha_f g = (1 - alpha_f) F' + alpha_f F,

g = 2 xi omega v + omega^2 q (Chung & Hulbert, J. Appl. Mech. 60, 1993). One step multiplies
(q, dt v, dt^2 a) by the amplification matrix, whose eigenvalues decide on stability (Hughes, The
Finite Element Method, 2000, section 9.3). Constants are (alpha_m, alpha_f, beta, gamma), and
x = omega dt.

Linear undamped systems decouple into such modes (`leapfrog.modes`), and so do those with dashpots
in proportion to their springs, xi = eta omega / 2."""

from typing import NamedTuple

import numpy as np

Constants = tuple[float, float, float, float]
Values = np.ndarray | float


class Motion(NamedTuple):
    """Displacement (m), velocity (m/s) and acceleration (m/s2), each [modes, steps + 1]."""

    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def amplification(constants: Constants, x: Values) -> np.ndarray:
    """Return what a step without load or damping multiplies (q, dt v, dt^2 a) by, [..., 3, 3];
    x : omega dt, of any shape."""
    return np.linalg.solve(*_both_ends(constants, x, 0.0))


def spectral_radius(constants: Constants, x: Values) -> np.ndarray:
    """Return the largest factor by which a step multiplies the mode; above 1 it grows."""
    return np.abs(np.linalg.eigvals(amplification(constants, x))).max(axis=-1)


def response(
    constants: Constants, omega: np.ndarray, force: np.ndarray, dt: float, xi: Values = 0.0
) -> Motion:
    """Return the exact discrete motion of modes from rest: the method itself, step by step.

    Parameters
    ----------
    omega, xi : frequencies, rad/s, and damping ratios, float arrays [modes].
    force : float array [modes, steps + 1], over the modal mass, m/s2, at steps 0, 1, ...
    dt : s."""
    alpha_f = constants[1]
    new, old = _both_ends(constants, omega * dt, np.broadcast_to(xi, omega.shape))
    out = np.zeros((*force.shape, 3))
    out[:, 0, 2] = dt**2 * force[:, 0]
    load = dt**2 * ((1 - alpha_f) * force[:, 1:] + alpha_f * force[:, :-1])
    step = np.linalg.inv(new)
    for n in range(force.shape[1] - 1):
        right = np.einsum("mij,mj->mi", old, out[:, n])
        right[:, 2] += load[:, n]
        out[:, n + 1] = np.einsum("mij,mj->mi", step, right)
    return Motion(out[..., 0], out[..., 1] / dt, out[..., 2] / dt**2)


def _both_ends(constants: Constants, x: Values, xi: Values) -> tuple[np.ndarray, np.ndarray]:
    """Return L, R [..., 3, 3] of L X' = R X, X = (q, dt v, dt^2 a): the method as it stands."""
    alpha_m, alpha_f, beta, gamma = constants
    x, xi = np.broadcast_arrays(np.asarray(x, dtype=float), xi)
    one, zero = np.ones_like(x), np.zeros_like(x)
    drag, spring = 2 * xi * x, x**2
    new = [
        [one, zero, -beta * one],
        [zero, one, -gamma * one],
        [(1 - alpha_f) * spring, (1 - alpha_f) * drag, (1 - alpha_m) * one],
    ]
    old = [
        [one, one, (0.5 - beta) * one],
        [zero, one, (1 - gamma) * one],
        [-alpha_f * spring, -alpha_f * drag, -alpha_m * one],
    ]
    return _matrices(new), _matrices(old)


def _matrices(rows: list[list[np.ndarray]]) -> np.ndarray:
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
