"""A manufactured motion of an elastic body, and the loads under which it is the exact one.

Every component of the displacement is a standing wave with a wave vector k_i of its own, so that
nothing of the operators cancels (manufactured solutions: Roache, J. Fluids Eng. 124, 2002):

    u_i(x, t) = g(t) sin(theta_i),   theta_i = k_i . x + phi_i

In isotropic rock with Lame's constants lambda and G and density rho

    sigma_ij = g (lambda delta_ij sum_l D_ll + G (D_ij + D_ji)),   D_ij = k_ij cos(theta_i)

and the body force is rho u'' - div sigma, the traction on the surface sigma n: on a test function v
both together do the work of rho u'' . v + sigma : grad v. g(t) = sin(omega t + psi)."""

from typing import NamedTuple

import numpy as np


class Manufactured(NamedTuple):
    """wave : float array [dim, dim], k_i of component i, 1/m; phase : phi_i [dim]; amplitude 1 m.

    omega, start : of g, rad/s and rad."""

    wave: np.ndarray
    phase: np.ndarray
    omega: float
    start: float

    def history(self, t: float) -> float:
        """Return g at a time (s)."""
        return float(np.sin(self.omega * t + self.start))

    def acceleration(self, t: float) -> float:
        """Return g'' (1/s2) at a time (s)."""
        return -(self.omega**2) * self.history(t)

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """Return u / g [n, dim] (m) at places x [n, dim] (m)."""
        return np.sin(self._angle(x))

    def stress(self, x: np.ndarray, lame: float, shear: float) -> np.ndarray:
        """Return sigma / g [n, dim, dim] (Pa), tension positive; lambda and G in Pa."""
        gradient = self.wave * np.cos(self._angle(x))[:, :, None]
        dilatation = np.trace(gradient, axis1=1, axis2=2)
        symmetric = gradient + gradient.transpose(0, 2, 1)
        return lame * dilatation[:, None, None] * np.eye(len(self.wave)) + shear * symmetric

    def _angle(self, x: np.ndarray) -> np.ndarray:
        return x @ self.wave.T + self.phase
