"""Contacts across a periodic boundary: of the blocks at one side with those at the other."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.periodic import contacts_across
from jointwave.cases.partition.blocks import Contacts, Partition, plane_contacts
from jointwave.cases.schema.rock_mass import RockMass

#: The sides that a periodic domain joins, and the axis across them.
PAIRS = {"left": ("right", 0), "bottom": ("top", 1)}


class Across(NamedTuple):
    """Contacts across a pair of periodic sides, of a joint set where a joint lies along both sides.
    shift : [2], m, offset of blocks j. sides : names of the pair."""

    contacts: Contacts
    shift: np.ndarray
    sides: tuple[str, str]


def across_periodic(scene: RockMass, partition: Partition) -> list[Across]:
    """Return the contacts across the periodic sides of a scene; raises GeometryError where they do
    not fit each other."""
    size = np.ptp(partition.corners, axis=0)
    return [
        Across(periodic_contacts(partition, side), size * np.eye(2)[axis], (side, other))
        for side, (other, axis) in PAIRS.items()
        if getattr(scene.boundaries, side) == "periodic"
    ]


def of_all(partition: Partition, across: list[Across], key: str) -> np.ndarray:
    """Return an array of all contacts, those across periodic sides last."""
    parts = partition.contacts, *(one.contacts for one in across)
    return np.concatenate([getattr(part, key) for part in parts])


def periodic_contacts(partition: Partition, side: str) -> Contacts:
    """Return the contacts across the left or the bottom, with the blocks beyond it moved by the
    domain's extent: block i at the right or the top, block j at the left or the bottom.

    Ends and normals are those at block i, in no order of i and j. Raises GeometryError where the
    sides do not fit each other.
    """
    other, axis = PAIRS[side]
    names = partition.joint_sets
    return plane_contacts(contacts_across(partition.blocks, axis, (side, other), names))
