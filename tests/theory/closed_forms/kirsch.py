"""A circular hole cut from rock under a uniform stress, in plane strain (Kirsch 1898).

With p = (P_x + P_y)/2, q = (P_x - P_y)/2, s = (a/r)^2, compression positive, from the rock before
the hole was there (Jaeger, Cook & Zimmerman, Fundamentals of Rock Mechanics, 2007, 8.5),

    sigma_rr = p (1 - s) + q (1 - 4 s + 3 s^2) cos 2t
    sigma_tt = p (1 + s) - q (1 + 3 s^2) cos 2t
    sigma_rt = -q (1 + 2 s - 3 s^2) sin 2t
    2 G u_r = -(a^2/r) (p + q (4 (1 - nu) - s) cos 2t)
    2 G u_t = (a^2/r) q (2 (1 - 2 nu) + s) sin 2t"""

from typing import NamedTuple

import numpy as np


class Kirsch(NamedTuple):
    """radius : m. stress : P_x and P_y, Pa. modulus, poisson : Young's, Pa, and Poisson's ratio."""

    radius: float
    stress: tuple[float, float]
    modulus: float
    poisson: float

    def stress_at(self, x: np.ndarray) -> np.ndarray:
        """Return the stress tensor at places [n, 2], m: [n, 2, 2], Pa."""
        p, q, s, t, turn = self._at(x)
        rr = p * (1 - s) + q * (1 - 4 * s + 3 * s**2) * np.cos(2 * t)
        tt = p * (1 + s) - q * (1 + 3 * s**2) * np.cos(2 * t)
        rt = -q * (1 + 2 * s - 3 * s**2) * np.sin(2 * t)
        polar = np.stack([np.stack([rr, rt], axis=-1), np.stack([rt, tt], axis=-1)], axis=-2)
        return turn @ polar @ np.swapaxes(turn, 1, 2)

    def displacement_at(self, x: np.ndarray) -> np.ndarray:
        """Return what the hole moves places [n, 2], m, by: [n, 2], m."""
        p, q, s, t, turn = self._at(x)
        nu, shear = self.poisson, self.modulus / 2 / (1 + self.poisson)
        scale = np.sqrt(s) * self.radius / (2 * shear)
        r = -scale * (p + q * (4 * (1 - nu) - s) * np.cos(2 * t))
        along = scale * q * (2 * (1 - 2 * nu) + s) * np.sin(2 * t)
        return np.einsum("nij,nj->ni", turn, np.stack([r, along], axis=-1))

    def _at(self, x: np.ndarray):
        (x_, y), (P_x, P_y) = np.transpose(x), self.stress
        t = np.arctan2(y, x_)
        c, d = np.cos(t), np.sin(t)
        turn = np.stack([np.stack([c, -d], axis=-1), np.stack([d, c], axis=-1)], axis=-2)
        return (P_x + P_y) / 2, (P_x - P_y) / 2, self.radius**2 / (x_**2 + y**2), t, turn
