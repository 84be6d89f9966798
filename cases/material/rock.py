"""Isotropic elastic rock by its density and the speeds of its waves."""

from dataclasses import dataclass

import numpy as np

from jointwave.cases.material.elastic import speeds_from_modulus
from jointwave.cases.schema.plane import IntactRock

Values = float | np.ndarray


@dataclass(frozen=True)
class ElasticRock:
    """Isotropic rock: density (kg/m3) and the speeds of P and S waves (m/s), or arrays of them."""

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
