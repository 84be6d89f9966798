"""A harmonic wave through a layer of softer rock, and through the joint that stands for it.

Layer of impedance Z_2 and thickness h between half-spaces of Z_1 (Brekhovskikh, Waves in Layered
Media, 1980), k_2 = omega / c_2:

    |T|^2 = 1 / (1 + (Z_1/Z_2 - Z_2/Z_1)^2 sin^2(k_2 h) / 4)

The massless joint of the same compliance has K = M_2/h with the layer's modulus M_2 = Z_2 c_2, so
that kappa = K / (Z_1 omega) = (Z_2/Z_1) / (k_2 h).
"""

from math import sin, sqrt


def transmission(impedance_ratio: float, phase: float) -> float:
    """Return |T| of a layer of Z_2/Z_1 and k_2 h (rad)."""
    contrast = 1 / impedance_ratio - impedance_ratio
    return 1 / sqrt(1 + contrast**2 * sin(phase) ** 2 / 4)
