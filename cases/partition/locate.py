"""The block that a point lies in, and the contact that is nearest to it."""

from __future__ import annotations

import numpy as np
import shapely

from cases.partition.blocks import Partition
from cases.partition.outline import TOLERANCE
from cases.partition.polygons import owner
from cases.partition.subdivision import OUTSIDE


def block_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the block that each point (float array [m, 2], m) lies in, or OUTSIDE; of blocks that
    share it, the first."""
    ring = shapely.linearrings(_closed(partition), indices=_closed_owner(partition))
    size = float(np.hypot(*np.ptp(partition.corners, axis=0)))
    found = _nearest(shapely.polygons(ring), points, TOLERANCE * size)
    return np.where(found < 0, OUTSIDE, found)


def contact_at(
    partition: Partition, points: np.ndarray, joint_set: int | None = None
) -> np.ndarray:
    """Return the contact nearest to each point (float array [m, 2], m), of one joint set or of any;
    of those as near, the first.

    Raises ValueError where there is no such contact.
    """
    contacts = partition.contacts
    of_set = contacts.joint_set >= 0 if joint_set is None else contacts.joint_set == joint_set
    chosen = np.flatnonzero(of_set)
    if not len(chosen):
        raise ValueError("there is no contact")
    ends = np.stack([contacts.start[chosen], contacts.end[chosen]], axis=1)
    return chosen[_nearest(shapely.linestrings(ends), points, np.inf)]


def _nearest(shapes: np.ndarray, points: np.ndarray, reach: float) -> np.ndarray:
    """Return the nearest shape within reach of each point, the first of several; -1 for none."""
    (which, shape), distance = shapely.STRtree(shapes).query_nearest(
        shapely.points(points), all_matches=True, return_distance=True
    )
    found = np.full(len(points), len(shapes))
    near = distance <= reach
    np.minimum.at(found, which[near], shape[near])
    return np.where(found == len(shapes), -1, found)


def _closed(partition: Partition) -> np.ndarray:
    """Return the corners of all blocks, each ring with its first corner at its end again."""
    return np.insert(
        partition.corners, partition.first[1:], partition.corners[partition.first[:-1]], 0
    )


def _closed_owner(partition: Partition) -> np.ndarray:
    whose = owner(partition.first)
    return np.insert(whose, partition.first[1:], np.arange(partition.count))
