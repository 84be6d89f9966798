"""A harmonic wave through N equal parallel joints at equal spacing.

A joint, kappa = K/(Z omega), and the rock up to the next one multiply the wave by a matrix of unit
determinant. Its Bloch phase phi and the rock's theta = 2 pi spacing / wavelength are bound by

    cos(phi) = cos(theta) - sin(theta) / (2 kappa)

and N of them pass (Cai & Zhao, Int. J. Rock Mech. Min. Sci. 37, 2000; the power of a unimodular
matrix by Chebyshev polynomials: Born & Wolf, Principles of Optics, 1999, section 1.6.5)

    1 / |T|^2 = 1 + (sin(N phi) / sin(phi))^2 / (4 kappa^2)

phi is real in a pass band and complex in a stop band. N = 1 is the joint of `one_joint`."""

from math import pi

import numpy as np


def transmission(count: int, kappa: float, spacing: float) -> float:
    """Return |T| of `count` joints; `spacing` over the wavelength."""
    theta = 2 * pi * spacing
    phi = np.arccos(complex(np.cos(theta) - np.sin(theta) / (2 * kappa)))
    waves = np.sin(count * phi) / np.sin(phi) if abs(np.sin(phi)) > 1e-9 else complex(count)
    return float(1 / np.sqrt(1 + abs(waves) ** 2 / (4 * kappa**2)))
