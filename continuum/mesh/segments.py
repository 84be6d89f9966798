"""The edges of a partition's blocks, cut where blocks meet, as shared by the meshes of the
blocks."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.periodic import Across

SAME = 1e-9  # of the domain: tolerance for coincident points
STRAIGHT = 1e-6  # largest sine of the angle between collinear edges
#: Start of the loop around a block: at the first corner from this direction on, rad. No edge of a
#: scene is likely to have it, so that equal blocks start at the same corner.
BEGIN = 0.7391


class Segments(NamedTuple):
    """Straight pieces of the edges of blocks, ending wherever any block has a corner.

    x : float array [points, 2], m, of the ends. point : int array [s, 2], first and last end.
    length : [s], m.
    contact : int array [s], index of the contact, those across periodic sides after the
    partition's; -1 on the boundary. side : int array [s], of the partition; -1 of contacts.
    like : int array [s], the segment with the same nodes, shifted by the period; else itself.
    """

    x: np.ndarray
    point: np.ndarray
    length: np.ndarray
    contact: np.ndarray
    side: np.ndarray
    like: np.ndarray


class Loops(NamedTuple):
    """The loop around each block, counter-clockwise, one block after the other.

    first : int array [blocks + 1]. segment : int array [n]. forward : bool array [n], whether it is
    traversed from its first end. is_corner : bool array [n], whether the block has a corner at its
    start.
    """

    first: np.ndarray
    segment: np.ndarray
    forward: np.ndarray
    is_corner: np.ndarray


def segments_of(partition: Partition, across: list[Across]) -> tuple[Segments, Loops]:
    """Return the segments of a partition and the loops around its blocks.

    across : contacts across periodic sides, whose edges replace those of the boundary.
    """
    contacts, boundary = partition.contacts, partition.boundary
    periodic = [name for one in across for name in one.sides]
    kept = ~np.isin(boundary.side, [partition.sides.index(name) for name in periodic])
    ends = [np.stack([contacts.start, contacts.end], axis=1)]
    blocks = [(np.arange(len(contacts)), contacts.blocks[:, side]) for side in (0, 1)]
    contact, side = [np.arange(len(contacts))], [np.full(len(contacts), -1)]
    count, number = len(contacts), len(contacts)
    like = [np.arange(count)]
    for one, shift, _ in across:
        own = np.stack([one.start, one.end], axis=1)
        for beyond in (0, 1):
            here = count + np.arange(len(one))
            ends.append(own - beyond * shift)
            blocks.append((here, one.blocks[:, beyond]))
            contact.append(number + np.arange(len(one)))
            side.append(np.full(len(one), -1))
            like.append(here - beyond * len(one))
            count += len(one)
        number += len(one)
    free = int(kept.sum())
    ends.append(np.stack([boundary.start, boundary.end], axis=1)[kept])
    blocks.append((count + np.arange(free), boundary.blocks[kept, 0]))
    contact.append(np.full(free, -1))
    side.append(boundary.side[kept])
    like.append(count + np.arange(free))
    every = np.concatenate(ends)
    x, point = _points(every)
    segments = Segments(
        x,
        point,
        np.hypot(*(every[:, 1] - every[:, 0]).T),
        *(np.concatenate(parts) for parts in (contact, side, like)),
    )
    own, block = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    return segments, _loops(partition, segments, own, block)


def _points(ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distinct points [n, 2] among ends [s, 2, 2], and the index of each end [s, 2]."""
    every = ends.reshape(-1, 2)
    near = cKDTree(every).query_pairs(SAME * np.ptp(every, axis=0).max(), output_type="ndarray")
    graph = coo_matrix((np.ones(len(near)), near.T), 2 * every.shape[:1])
    group = connected_components(graph, directed=False)[1]
    _, first, number = np.unique(group, return_index=True, return_inverse=True)
    return every[first], number.reshape(-1, 2)


def _loops(
    partition: Partition, segments: Segments, segment: np.ndarray, block: np.ndarray
) -> Loops:
    """Return the loops around all blocks, from pairs of a segment [n] and its block [n]."""
    ends = segments.x[segments.point[segment]]
    arm = ends - partition.centroid[block][:, None]
    turn = arm[:, 0, 0] * arm[:, 1, 1] - arm[:, 0, 1] * arm[:, 1, 0]
    forward = turn > 0
    begin = np.where(forward[:, None], arm[:, 0], arm[:, 1])
    angle = np.mod(np.arctan2(begin[:, 1], begin[:, 0]) - BEGIN, 2 * np.pi)
    order = np.lexsort((angle, block))
    segment, forward, block = segment[order], forward[order], block[order]
    count = np.bincount(block, minlength=partition.count)
    first = np.concatenate([[0], np.cumsum(count)])
    along = np.where(forward[:, None], 1, -1) * np.diff(ends[order], axis=1)[:, 0]
    along /= segments.length[segment][:, None]
    before = np.arange(len(segment)) - 1
    before[first[:-1]] = first[1:] - 1
    sine = along[before, 0] * along[:, 1] - along[before, 1] * along[:, 0]
    return Loops(first, segment, forward, sine > STRAIGHT)
