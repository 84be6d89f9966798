"""P and SV waves at one joint: what passes and returns, and the energy that it carries."""

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.waves import KINDS, Kind, cosines, slowness_along


def coefficients(
    incidence: Kind, angle: Values, omega: Values, rock: ElasticRock, joint: Joint
) -> np.ndarray:
    """Return R_p, R_s, T_p, T_s of one joint [4, ...], all arguments broadcast together."""
    return parallel_joints.coefficients(incidence, angle, omega, rock, [joint], [])


def energy_flux(incidence: Kind, angle: Values, rock: ElasticRock, found: np.ndarray) -> np.ndarray:
    """Return the shares of the incident energy flux that R_p, R_s and, at joints, T_p, T_s carry
    away, array [2 or 4, ...]; evanescent waves carry none."""
    c, k = (x.real for x in cosines(rock, slowness_along(rock, incidence, angle)))
    carried = np.stack(np.broadcast_arrays(rock.p_impedance * c, rock.s_impedance * k))
    shares = carried / carried[KINDS.index(incidence)]
    return np.abs(found) ** 2 * np.concatenate([shares, shares])[: len(found)]
