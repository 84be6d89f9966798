"""Leapfrog on the uniform undamped free-free chain, in closed form: the rigid-block engine itself.

    m (v^{n+1/2} - v^{n-1/2}) = dt (F^n - K u^n),   u^{n+1} = u^n + dt v^{n+1/2},   at rest at n = 0

decouples in the chain's modes. With sin(Omega dt / 2) = omega_n dt / 2, the discrete Green's
function of each mode gives

    q^j = (dt^2 / m_n) sum_{k < j} F^k sin((j - k) Omega dt) / sin(Omega dt)

and (j - k) in place of the quotient for the rigid mode. It follows from the recursion
q^{j+1} - 2 cos(Omega dt) q^j + q^{j-1} = dt^2 F^j / m_n; derived for this project.
"""

import numpy as np

from compare.exact.lattice import frequencies


def displacements(
    force: np.ndarray, steps: np.ndarray, dt: float, stiffness: float, mass: float, block_count: int
) -> np.ndarray:
    """Return the displacement (m) of all blocks [block_count, len(steps)] after these steps.

    Parameters
    ----------
    force : float array [n], force (N) on block 1 at steps 0, 1, ...; n at least max(steps).
    steps : int array of step numbers.
    dt : step, s, below the critical one, 2 / omega_max, where the highest mode would be double.
    stiffness, mass : of every joint (N/m) and block (kg).
    """
    half = frequencies(stiffness, mass, block_count) * dt / 2
    if half.max() >= 1:
        raise ValueError(f"the step must be below the critical {dt / half.max():.6g} s")
    centres = np.arange(block_count) + 0.5
    shapes = np.cos(np.outer(centres, np.arange(block_count)) * np.pi / block_count)
    modal_mass = mass * (shapes**2).sum(axis=0)
    forcing = shapes[0] * dt**2 / modal_mass
    modes = [_rigid(force, steps), *(_mode(force, steps, 2 * np.arcsin(x)) for x in half[1:])]
    return shapes @ (forcing[:, None] * np.array(modes))


def _rigid(force: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return sum_{k < j} F^k (j - k)."""
    return np.concatenate([[0.0], np.cumsum(np.cumsum(force))])[steps]


def _mode(force: np.ndarray, steps: np.ndarray, angle: float) -> np.ndarray:
    """Return sum_{k < j} F^k sin((j - k) angle) / sin(angle)."""
    turned = np.cumsum(force * np.exp(-1j * angle * np.arange(len(force))))
    sums = np.concatenate([[0.0], turned])[steps]
    return (sums * np.exp(1j * angle * steps)).imag / np.sin(angle)
