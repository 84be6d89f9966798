"""The lowest frequency at which a slender beam swings that is clamped at one end.

Euler and Bernoulli: omega = beta^2 sqrt(E I / (rho A L^4)) with cos(beta) cosh(beta) = -1.
Timoshenko's beam shears and its sections turn; with b = omega / sqrt(E I / (rho A L^4)),
r^2 = I / (A L^2), s^2 = E I / (kappa G A L^2) (Huang, J. Appl. Mech. 28, 1961)

    2 + (b^2 (r^2 - s^2)^2 + 2) cosh(b p) cos(b q) - b (r^2 + s^2) / sqrt(1 - b^2 r^2 s^2)
        sinh(b p) sin(b q) = 0,   2 p^2, 2 q^2 = -+(r^2 + s^2) + sqrt((r^2 - s^2)^2 + 4/b^2)

Cowper's kappa of the rectangle is 10 (1 + nu) / (12 + 11 nu) (J. Appl. Mech. 33, 1966)."""

from math import cos, cosh, sin, sinh, sqrt

BETA = 1.8751040687119611


def euler_bernoulli(modulus: float, density: float, height: float, length: float) -> float:
    """Return omega (rad/s) of a rectangular beam; Pa, kg/m3, m, m."""
    return BETA**2 * _scale(modulus, density, height, length)


def timoshenko(modulus: float, nu: float, density: float, height: float, length: float) -> float:
    """Return omega (rad/s) of a rectangular beam with shear and rotary inertia."""
    from scipy.optimize import brentq

    kappa = 10 * (1 + nu) / (12 + 11 * nu)
    r2 = height**2 / (12 * length**2)
    s2 = r2 * 2 * (1 + nu) / kappa

    def balance(b: float) -> float:
        root = sqrt((r2 - s2) ** 2 + 4 / b**2)
        p, q = sqrt((root - r2 - s2) / 2), sqrt((root + r2 + s2) / 2)
        sheared = b * (r2 + s2) / sqrt(1 - b**2 * r2 * s2) * sinh(b * p) * sin(b * q)
        return 2 + (b**2 * (r2 - s2) ** 2 + 2) * cosh(b * p) * cos(b * q) - sheared

    # Shear and rotation only soften, and slender beams little.
    b = brentq(balance, 0.5 * BETA**2, 1.0001 * BETA**2, xtol=1e-14)
    return b * _scale(modulus, density, height, length)


def _scale(modulus: float, density: float, height: float, length: float) -> float:
    return sqrt(modulus * height**2 / (12 * density * length**4))
