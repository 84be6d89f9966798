"""Stiffness from wave speeds and back: Guo & Li (2002), (4) and (5).

The rock mass is intact rock in series with its joints. Rigid blocks have no compliance of their
own, so their joints carry all of it: K' = E_eq / S, (6), and in shear G / S, (7).
"""

from math import inf, sqrt


def modulus_from_speeds(p_speed: float, s_speed: float, density: float) -> tuple[float, float]:
    """Return Young's modulus (Pa) and Poisson's ratio of a medium of these speeds (m/s)."""
    p2, s2 = p_speed**2, s_speed**2
    poisson = (p2 - 2 * s2) / (2 * (p2 - s2))
    return 2 * density * s2 * (1 + poisson), poisson


def speeds_from_modulus(modulus: float, poisson: float, density: float) -> tuple[float, float]:
    """Return the P and S speeds (m/s) of an unbounded medium; inverse of modulus_from_speeds."""
    s2 = shear_modulus(modulus, poisson) / density
    return sqrt(s2 * 2 * (1 - poisson) / (1 - 2 * poisson)), sqrt(s2)


def shear_modulus(modulus: float, poisson: float) -> float:
    """Return G (Pa) of Young's modulus (Pa) and Poisson's ratio."""
    return modulus / (2 * (1 + poisson))


def joint_stiffness(equivalent: float, intact: float, spacing: float) -> float:
    """Return the joint's own K_n (Pa/m) that gives the rock mass its modulus, equation (4);
    infinite where that is the intact rock's."""
    if equivalent == intact:
        return inf
    return 1 / (spacing * (1 / equivalent - 1 / intact))


def equivalent_modulus(stiffness: float, intact: float, spacing: float) -> float:
    """Return E_eq (Pa) of intact rock with joints K_n at this spacing; inverse of (4)."""
    return 1 / (1 / intact + 1 / (spacing * stiffness))
