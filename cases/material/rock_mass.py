"""The numbers of a rock mass in the plane: inertia of its blocks, stiffness of its joints.

Plane strain: masses and forces are per metre of thickness.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.partition.blocks import Partition
from jointwave.cases.schema.plane import IntactRock


class Inertia(NamedTuple):
    """Of each block: mass [n], kg/m, and moment of inertia about the centroid [n], kg m."""

    mass: np.ndarray
    moment: np.ndarray


class Stiffness(NamedTuple):
    """Of each contact: normal and shear stiffness [c], Pa/m."""

    normal: np.ndarray
    shear: np.ndarray


def inertia(partition: Partition, density: float | np.ndarray) -> Inertia:
    """Return the inertia of blocks of a density (kg/m3), of all or of each [n]."""
    return Inertia(density * partition.area, density * partition.polar_moment)


def constrained_modulus(rock: IntactRock) -> float:
    """Return the P-wave modulus of intact rock, Pa."""
    poisson = rock.intact_poisson
    return rock.intact_modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
