"""Isotropic elastic rock: wave speeds and moduli, and conversions; Guo & Li (2002), (4) and (5).

The rock mass is intact rock in series with its joints. Rigid blocks have no compliance, so their
joints carry all of it: K' = E_eq / S, (6), and in shear G / S, (7).
"""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from jointwave.cases.schema.rock_mass import IntactRock

Values = float | np.ndarray


@dataclass(frozen=True)
class ElasticRock:
    """Isotropic rock: density (kg/m3) and speeds of P and S waves (m/s), or arrays of them."""

    density: Values
    p_speed: Values
    s_speed: Values

    @property
    def p_impedance(self) -> Values:
        """Z_p = rho a, Pa s/m."""
        return self.density * self.p_speed

    @property
    def s_impedance(self) -> Values:
        """Z_s = rho b, Pa s/m."""
        return self.density * self.s_speed

    @property
    def shear_modulus(self) -> Values:
        """mu = rho b^2, Pa."""
        return self.density * self.s_speed**2

    @property
    def lame(self) -> Values:
        """lambda = rho (a^2 - 2 b^2), Pa."""
        return self.density * (self.p_speed**2 - 2 * self.s_speed**2)


def elastic_rock(rock: IntactRock) -> ElasticRock:
    """Return the rock between the joints of a scene."""
    speeds = speeds_from_modulus(rock.intact_modulus, rock.intact_poisson, rock.density)
    return ElasticRock(rock.density, *speeds)


def modulus_from_speeds(p_speed: float, s_speed: float, density: float) -> tuple[float, float]:
    """Return Young's modulus (Pa) and Poisson's ratio from wave speeds (m/s)."""
    p2, s2 = p_speed**2, s_speed**2
    poisson = (p2 - 2 * s2) / (2 * (p2 - s2))
    return 2 * density * s2 * (1 + poisson), poisson


def speeds_from_modulus(modulus: float, poisson: float, density: float) -> tuple[float, float]:
    """Return the P and S speeds (m/s) of an unbounded medium; inverse of modulus_from_speeds."""
    s2 = shear_modulus(modulus, poisson) / density
    return sqrt(s2 * 2 * (1 - poisson) / (1 - 2 * poisson)), sqrt(s2)


def shear_modulus(modulus: float, poisson: float) -> float:
    """Return G (Pa) from Young's modulus (Pa) and Poisson's ratio."""
    return modulus / (2 * (1 + poisson))


def wave_moduli(rock: IntactRock) -> np.ndarray:
    """Return the P-wave and the S-wave modulus of the rock between joints [2], Pa."""
    E, poisson = rock.intact_modulus, rock.intact_poisson
    constrained = E * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    return np.array([constrained, shear_modulus(E, poisson)])


def joint_stiffness(equivalent: float, intact: float, spacing: float) -> float:
    """Return the joint's own K_n (Pa/m) from the moduli, equation (4); infinite if equal."""
    if equivalent == intact:
        return inf
    return 1 / (spacing * (1 / equivalent - 1 / intact))


def equivalent_modulus(stiffness: float, intact: float, spacing: float) -> float:
    """Return E_eq (Pa) of intact rock with joints K_n at this spacing; inverse of (4)."""
    return 1 / (1 / intact + 1 / (spacing * stiffness))
