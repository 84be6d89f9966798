"""The numbers of a rock mass in the plane: inertia of its blocks, dashpots of its joints.

Plane strain: masses and forces are per metre of thickness.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from jointwave.cases.partition.joints import attitude
from jointwave.cases.partition.regions import rocks_beside
from jointwave.cases.schema.plane import IntactRock
from jointwave.cases.schema.rock_mass import RockMass


class Stiffness(NamedTuple):
    """Of each contact: normal and shear stiffness [c], Pa/m."""

    normal: np.ndarray
    shear: np.ndarray


def constrained_modulus(rock: IntactRock) -> float:
    """Return the P-wave modulus of intact rock, Pa."""
    poisson = rock.intact_poisson
    return rock.intact_modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))


def set_time_constants(scene: RockMass) -> np.ndarray | None:
    """Return eta of each joint set of a rock mass, normal and in shear, s [sets]; None without any
    dashpot.

    The mass in c_n = 2 zeta sqrt(m k_n) is that of the rock from joint to joint: its density times
    the spacing, or half of the domain's extent across a joint that is alone.
    """
    sets = scene.joint_sets
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return np.full(len(sets), beta) if beta else None
    if not any(one.damping_ratio for one in sets):
        return None
    corners, found = np.array(scene.domain.corners), []
    for one in sets:
        assert one.normal_stiffness is not None
        extent = float(np.ptp(corners @ attitude(one, scene.domain.dimension)[0]))
        mass = rocks_beside(scene, one)[0].density * (one.spacing or extent / 2)
        found.append(2 * (one.damping_ratio or 0.0) * sqrt(mass / one.normal_stiffness))
    return np.array(found)
