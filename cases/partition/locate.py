"""The block that a point lies in, and the contact that is nearest to it."""

import numpy as np
import shapely

from cases.partition.blocks import Partition
from cases.partition.outline import TOLERANCE
from cases.partition.polygons import owner
from cases.partition.subdivision import OUTSIDE


def block_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the block that each point (float array [m, 2], m) lies in, or OUTSIDE; of blocks that
    share it, the first."""
    corners, first, whose = partition.corners, partition.first, owner(partition.first)
    # Each ring has its first corner at its end again.
    closed = np.insert(corners, first[1:], corners[first[:-1]], 0)
    owners = np.insert(whose, first[1:], np.arange(partition.count))
    ring = shapely.linearrings(closed, indices=owners)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    which, block = shapely.STRtree(shapely.polygons(ring)).query(
        shapely.points(points), predicate="dwithin", distance=TOLERANCE * size
    )
    return _first(which, block, len(points))


def contact_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the contact of a joint set that is nearest to each point (float array [m, 2], m); of
    those as near, the first.

    Raises ValueError where there is no such contact.
    """
    contacts = partition.contacts
    chosen = np.flatnonzero(contacts.of_joints(len(partition.joint_sets)))
    if not len(chosen):
        raise ValueError("there is no contact")
    ends = np.stack([contacts.start[chosen], contacts.end[chosen]], axis=1)
    tree = shapely.STRtree(shapely.linestrings(ends))
    which, found = tree.query_nearest(shapely.points(points), all_matches=True)
    return chosen[_first(which, found, len(points))]


def _first(which: np.ndarray, found: np.ndarray, count: int) -> np.ndarray:
    """Return the smallest value found for each of `count` points, or OUTSIDE."""
    least = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(least, which, found)
    return np.where(least == np.iinfo(np.int64).max, OUTSIDE, least)
