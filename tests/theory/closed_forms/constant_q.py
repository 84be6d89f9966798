"""Waves in rock whose quality factor is the same at every frequency (Kjartansson, 1979).

    M(s) = M_0 (s / omega_0)^(2 gamma),   gamma = arctan(1/Q) / pi

has Im M / Re M = 1/Q at every s = i omega; the phase speed is c = c_0 (omega / omega_0)^gamma and
the attenuation a = omega tan(pi gamma / 2) / c, nearly omega / (2 Q c). With M_0 = rho c_0^2
cos^2(pi gamma / 2), c_0 is the phase speed at omega_0.

E. Kjartansson, Constant Q wave propagation and attenuation, J. Geophys. Res. 84 (1979), 4737-4748.
"""

from dataclasses import dataclass
from math import atan, pi, tan

import numpy as np


@dataclass(frozen=True)
class ConstantQ:
    """Rock of one quality factor at every frequency, and a reference frequency, Hz."""

    quality: float
    reference: float

    @property
    def gamma(self) -> float:
        """The exponent of the phase speed."""
        return atan(1 / self.quality) / pi

    def phase_speed(self, frequency: np.ndarray) -> np.ndarray:
        """Return c over c_0 at frequencies, Hz."""
        return (np.asarray(frequency) / self.reference) ** self.gamma

    def attenuation(self, frequency: np.ndarray, speed: float) -> np.ndarray:
        """Return how a plane wave decays with distance, 1/m; speed : c_0, m/s."""
        omega = 2 * pi * np.asarray(frequency)
        return omega * tan(pi * self.gamma / 2) / (speed * self.phase_speed(frequency))
