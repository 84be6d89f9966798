"""The numbers of a rock mass in the plane: inertia of its blocks, stiffness of its joints.

Plane strain: masses and forces are per metre of thickness.
"""

from typing import NamedTuple

import numpy as np

from cases.material.elastic import shear_modulus
from cases.partition.blocks import Partition
from cases.partition.subdivision import NO_SET
from cases.schema.plane import IntactRock
from cases.schema.rock_mass import RockMass


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


def joint_stiffness(scene: RockMass, partition: Partition) -> Stiffness:
    """Return each contact's own stiffness: that of its joint set, and in a cut through intact rock
    that of the rock between the centroids on both sides."""
    rock, sets = scene.rock, scene.joint_sets
    height = centroid_distance(partition)
    moduli = constrained_modulus(rock), shear_modulus(rock.intact_modulus, rock.intact_poisson)
    keys, found = ("normal_stiffness", "shear_stiffness"), []
    for key, modulus in zip(keys, moduli, strict=True):
        of_sets = np.array([*(getattr(one, key) for one in sets), np.nan])  # the last is NO_SET's
        of_contacts = of_sets[partition.contacts.joint_set]
        cuts = partition.contacts.joint_set == NO_SET
        found.append(np.where(cuts, modulus / height, of_contacts))
    return Stiffness(*found)


def centroid_distance(partition: Partition) -> np.ndarray:
    """Return the distance of the centroids of each contact's blocks along its normal [c], m."""
    i, j = partition.contacts.blocks.T
    apart = partition.centroid[j] - partition.centroid[i]
    return (apart * partition.contacts.normal).sum(axis=1)


def constrained_modulus(rock: IntactRock) -> float:
    """Return the P-wave modulus of intact rock, Pa."""
    poisson = rock.intact_poisson
    return rock.intact_modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
