"""Reflection of P and SV waves from a viscous boundary, against the angle.

Dashpots on the face, outward normal n: sigma_nn = -rho a v_n, sigma_tn = -rho b v_t (Lysmer &
Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969). Waves travel along +n, reflections along -n. With the
angles theta of P and phi of SV waves, sin(phi) / b = sin(theta) / a, s = sin phi, k = cos phi,
c = cos theta, C = cos 2 phi, S = (b/a) sin 2 phi and X = 2 s c, the amplitudes of particle velocity
satisfy

    -(C + c) r_p + (S + s) r_s             = C - c          |  s - S
     (X + sin theta) r_p + (C + k) r_s     = X - sin theta  |  C - k

for P | SV. They do not depend on frequency."""

import numpy as np

from jointwave.cases.material.rock import ElasticRock


def coefficients(incidence: str, angle: float, rock: ElasticRock) -> np.ndarray:
    """Return the complex r_p and r_s over the incident amplitude of particle velocity.

    incidence : "P" or "SV". angle : of travel from the normal, rad."""
    a, b = rock.p_speed, rock.s_speed
    slowness = np.sin(angle) / (a if incidence == "P" else b)
    s, along = b * slowness, a * slowness
    c, k = np.sqrt(1 - along**2 + 0j), np.sqrt(1 - s**2 + 0j)
    C, S, X = 1 - 2 * s**2, 2 * s * k * b / a, 2 * s * c
    sides = [C - c, X - along] if incidence == "P" else [s - S, C - k]
    return np.linalg.solve([[-(C + c), S + s], [X + along, C + k]], sides)
