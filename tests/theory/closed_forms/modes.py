"""Leapfrog on a linear undamped system, in closed form: the rigid-block engine itself.

    M (v^{n+1/2} - v^{n-1/2}) = dt (F^n - K u^n),   u^{n+1} = u^n + dt v^{n+1/2},   at rest at n = 0

decouples in the modes of (M, K). With sin(Omega dt / 2) = omega_n dt / 2, the discrete Green's
function of each mode gives

    q^j = (dt^2 / m_n) sum_{k < j} F^k sin((j - k) Omega dt) / sin(Omega dt)

and (j - k) in place of the quotient for a rigid mode. It follows from the recursion
q^{j+1} - 2 cos(Omega dt) q^j + q^{j-1} = dt^2 F^j / m_n; derived for this project."""

from typing import NamedTuple

import numpy as np

RIGID = 1e-12  # of the highest frequency; singular values are accurate to about 1e-15 of it


class Modes(NamedTuple):
    """Natural frequencies omega [n] (rad/s) and shapes [freedoms, n] of unit modal mass."""

    omega: np.ndarray
    shapes: np.ndarray


def of_modes(
    modes: Modes, place: np.ndarray, force: np.ndarray, steps: np.ndarray, dt: float
) -> np.ndarray:
    """Return the motion of every freedom [freedoms, len(steps)] after these steps.

    Parameters
    ----------
    place : float array [freedoms], generalised force on each degree of freedom per unit force.
    force : float array [n], force (N) at steps 0, 1, ...; n at least max(steps).
    steps : int array of step numbers.
    dt : step, s, below the critical one, 2 / omega_max, where the highest mode has a double root.
    """
    half = modes.omega * dt / 2
    if half.max() >= 1:
        raise ValueError(f"the step must be below the critical {dt / half.max():.6g} s")
    rigid = np.concatenate([[0.0], np.cumsum(np.cumsum(force))])[steps]
    sums = [_mode(force, steps, 2 * np.arcsin(x)) if x > 0 else rigid for x in half]
    return modes.shapes @ ((modes.shapes.T @ place * dt**2)[:, None] * np.array(sums))


def modes(mass: np.ndarray, root: np.ndarray) -> Modes:
    """Return the modes of the masses [n] and the stiffness K = root^T root, root [m, n]. The
    singular values of root M^{-1/2} give omega itself, so that low modes lose no digits."""
    _, omega, shapes = np.linalg.svd(root / np.sqrt(mass))
    omega = np.pad(omega, (0, max(0, len(mass) - len(omega))))
    omega[omega < RIGID * omega.max()] = 0
    return Modes(omega, shapes.T / np.sqrt(mass)[:, None])


def _mode(force: np.ndarray, steps: np.ndarray, angle: float) -> np.ndarray:
    """Return sum_{k < j} F^k sin((j - k) angle) / sin(angle)."""
    turned = np.cumsum(force * np.exp(-1j * angle * np.arange(len(force))))
    sums = np.concatenate([[0.0], turned])[steps]
    return (sums * np.exp(1j * angle * steps)).imag / np.sin(angle)
