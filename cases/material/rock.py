"""Isotropic elastic rock by its density and the speeds of its waves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointwave.cases.material.elastic import speeds_from_modulus

if TYPE_CHECKING:
    from jointwave.cases.schema.plane import IntactRock

Values = float | np.ndarray


@dataclass(frozen=True)
class ElasticRock:
    """Isotropic rock: density (kg/m3) and the speeds of P and S waves (m/s), or arrays of them."""

    density: Values
    p_speed: Values
    s_speed: Values

    def __post_init__(self) -> None:
        for name in ("density", "p_speed", "s_speed"):
            if not (np.asarray(getattr(self, name)) > 0).all():
                raise ValueError(f"{name} is {getattr(self, name)}, must be positive")
        if not (np.asarray(self.p_speed) > self.s_speed).all():
            raise ValueError(f"p_speed {self.p_speed} must be above s_speed {self.s_speed}")

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
