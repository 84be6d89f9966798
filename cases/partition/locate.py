"""The blocks that a point lies in, and the contact that is nearest to it."""

from collections.abc import Iterator

import numpy as np
import shapely

from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.outline import TOLERANCE


def block_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the block that each point (float array [m, 2], m) lies in, or OUTSIDE; of blocks that
    share it, the first."""
    return _first(*blocks_at(partition, points), len(points))


def blocks_at(partition: Partition, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (point, block) int arrays of every block that each point (float array [m, 2], m) lies
    in or, within 1e-9 of the partition's size, on the edge of."""
    corners, first, whose = partition.corners, partition.first, partition.owner
    # Each ring has its first corner at its end again.
    closed = np.insert(corners, first[1:], corners[first[:-1]], 0)
    owners = np.insert(whose, first[1:], np.arange(partition.count))
    ring = shapely.linearrings(closed, indices=owners)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    which, block = shapely.STRtree(shapely.polygons(ring)).query(
        shapely.points(points), predicate="dwithin", distance=TOLERANCE * size
    )
    return which, block


def sides_at(partition: Partition, points: np.ndarray) -> list[list[int]]:
    """Return the blocks that each point (float array [m, 2], m) is read in: one and, on joints, one
    on each side; none outside the rock.

    Of blocks that share a point without a joint between them it is the first.
    """
    found: list[set[int]] = [set() for _ in points]
    for k, block in zip(*blocks_at(partition, points), strict=True) if len(points) else ():
        found[k].add(int(block))
    near = rock_neighbours(partition) if any(len(here) > 1 for here in found) else {}
    return [[min(side) for side in _joined(here, near)] for here in found]


def _joined(blocks: set[int], near: dict[int, list[int]]) -> Iterator[set[int]]:
    """Yield blocks in groups that are joined by intact rock, that of the first block first."""
    left = set(blocks)
    while left:
        side, reached = set(), [min(left)]
        while reached:
            side.add(block := reached.pop())
            reached += (left - side).intersection(near.get(block, []))
        left -= side
        yield side


def rock_neighbours(partition: Partition) -> dict[int, list[int]]:
    """Return the blocks beside each across cuts through intact rock of one region."""
    contacts = partition.contacts
    found: dict[int, list[int]] = {}
    through = ~contacts.of_joints(len(partition.joint_sets))
    through &= np.diff(partition.region[contacts.blocks], axis=1)[:, 0] == 0
    for i, j in contacts.blocks[through].tolist():
        found.setdefault(i, []).append(j)
        found.setdefault(j, []).append(i)
    return found


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
