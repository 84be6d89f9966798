"""Waves along a square column with free sides, of any length against its side a.

Long waves of compression run at sqrt(E/rho) and are slowed by the inertia of the rock that they
widen (Rayleigh, Theory of Sound, 1894, section 157; Love, Treatise on the Mathematical Theory of
Elasticity, 1927, section 278); to second order in k

    c = sqrt(E/rho) (1 - nu^2 k^2 r_p^2 / 2),   r_p^2 = a^2/6

and in a strip of width a in plane stress, which widens one way only, r_p^2 = a^2/12. Long waves of
torsion run at sqrt(G J / (rho I_p)), with Saint-Venant's torsion constant of the square (Timoshenko
& Goodier, Theory of Elasticity, 1970, section 109)

    J = (a^4/3) (1 - (192/pi^5) sum_{n odd} tanh(n pi/2) / n^5) = 0.140577 a^4,   I_p = a^4/6"""

from math import pi, sqrt, tanh

TERMS = 60  # of the series: the next one is below 1e-12


def love_rayleigh(poisson: float, wave_number: float, side: float, dim: int = 3) -> float:
    """Return 1 - c / sqrt(E/rho) for long waves: nu^2 k^2 r_p^2 / 2. wave_number k in 1/m, side a
    in m; dim 3 the column, 2 the strip in plane stress."""
    radius = side**2 * (1 / 6 if dim == 3 else 1 / 12)
    return poisson**2 * wave_number**2 * radius / 2


def torsion_speed(shear_speed: float) -> float:
    """Return the speed (m/s) of long waves of torsion, 0.9184 times that of shear waves."""
    series = sum(tanh(n * pi / 2) / n**5 for n in range(1, 2 * TERMS, 2))
    return shear_speed * sqrt(2 * (1 - 192 / pi**5 * series))
