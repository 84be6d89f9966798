"""Reflection of P and SV waves from a viscous boundary, against the angle.

Dashpots on the face, outward normal n: sigma_nn = -alpha rho a v_n, sigma_tn = -beta rho b v_t
(Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969; alpha = beta = 1 is theirs). Waves travel
along +n, reflections along -n, axes and polarisations as in `waves`; with C = cos 2 phi,
S = sin 2 phi, X = 2 s c the amplitudes of particle velocity satisfy

    -(C + alpha c) r_p + ((b/a) S + alpha s) r_s = C - alpha c  |  alpha s - (b/a) S
     (X + beta a') r_p + (C + beta k) r_s        = X - beta a'  |  C - beta k

for P | SV. They do not depend on frequency. alpha = beta = 0 is a free face, infinite ones hold it.
"""

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane.waves import (
    KINDS,
    Kind,
    face,
    slowness_along,
)


def coefficients(
    incidence: Kind, angle: Values, rock: ElasticRock, dashpots: tuple[float, float] = (1.0, 1.0)
) -> tuple[np.ndarray, np.ndarray]:
    """Return the complex r_p and r_s over the incident amplitude of particle velocity.

    incidence : "P" or "SV". angle : of travel from the normal, rad, broadcasts with rock.
    dashpots : alpha and beta, 0 to inf.
    """
    r = reflection(rock, slowness_along(rock, incidence, angle), dashpots)
    i = KINDS.index(incidence)
    return r[..., 0, i], r[..., 1, i]


def reflection(
    rock: ElasticRock, slowness: Values, dashpots: tuple[float, float] = (1.0, 1.0)
) -> np.ndarray:
    """Return the matrix [..., out, in] of both incidences in the order P, SV; slowness in s/m."""
    w = face(rock, slowness)
    normal, n = _weighed(w.normal, w.normal_velocity, rock.p_impedance, dashpots[0])
    shear, t = _weighed(w.shear, w.shear_velocity, rock.s_impedance, dashpots[1])
    rows, sides = (normal - n, t - shear), (-normal - n, -t - shear)
    return np.linalg.solve(*(np.stack(np.broadcast_arrays(*x), axis=-2) for x in (rows, sides)))


def _weighed(traction, velocity, impedance, dashpot: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the terms of traction / Z + dashpot v = 0, over 1 + dashpot."""
    share = 1 / (1 + dashpot)
    return share * traction / np.asarray(impedance)[..., None], (1 - share) * velocity
