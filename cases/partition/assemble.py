"""From a subdivision to blocks: outlines, order, and one edge for each pair that touches."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointwave.cases.partition.blocks import BoundaryEdges, Contacts
from jointwave.cases.partition.polygons import moments
from jointwave.cases.partition.subdivision import OUTSIDE, NonConvex, Subdivision

#: Sine of the angle between edges below which they are one side of a block.
STRAIGHT = 1e-9


class Rings(NamedTuple):
    """Convex outlines: the cell of each [n], corners [k, 2], and the first corner of each
    [n + 1]."""

    cell: np.ndarray
    corners: np.ndarray
    first: np.ndarray


def rings(sub: Subdivision) -> Rings:
    """Return the outlines of all cells, counter-clockwise, without corners that turn nowhere.

    Raises NonConvex where a cell is not convex.
    """
    half = sub.halves()
    middle = (sub.points[half.start] + sub.points[half.end]) / 2 - sub.centres()[half.cell]
    order = np.lexsort([np.arctan2(middle[:, 1], middle[:, 0]), half.cell])
    cell, point, outward = half.cell[order], half.start[order], half.outward[order]
    begins = np.flatnonzero(np.diff(cell, prepend=-1))
    before = np.arange(-1, len(cell) - 1)
    before[begins] = np.append(begins[1:], len(cell)) - 1
    turn = outward[before, 0] * outward[:, 1] - outward[before, 1] * outward[:, 0]
    wrong = (half.end[order][before] != point) | (turn < -STRAIGHT)
    if wrong.any():
        raise NonConvex(sub.points[point[np.argmax(wrong)]], "a block is not convex")
    corner = turn > STRAIGHT
    number = np.add.reduceat(corner, begins, dtype=np.int64)
    return Rings(cell[begins], sub.points[point[corner]], np.append(0, np.cumsum(number)))


def ordered(sub: Subdivision, found: Rings) -> tuple[Subdivision, Rings]:
    """Return a subdivision and its outlines with cells numbered along rows across the domain, so
    that neighbours are near each other in memory."""
    m = moments(found.corners, found.first)
    centre = m.centroid - found.corners.min(axis=0)
    extent = np.ptp(found.corners, axis=0)
    long = int(extent[1] > extent[0])
    row = np.floor(centre[:, long] / np.sqrt(m.area.mean()))
    order = np.lexsort([centre[:, 1 - long], row])
    number = np.full(sub.count + 1, OUTSIDE)
    number[found.cell[order]] = np.arange(len(order))
    count = np.diff(found.first)[order]
    first = np.append(0, np.cumsum(count))
    at = np.repeat(found.first[:-1][order] - first[:-1], count) + np.arange(first[-1])
    cells = number[sub.cells]
    region = sub.region[found.cell[order]]
    return replace(sub, cells=cells, region=region, count=len(order)), Rings(
        np.arange(len(order)), found.corners[at], first
    )


def contacts(sub: Subdivision) -> Contacts:
    """Return the pairs of blocks that share an edge, with that edge."""
    half = sub.halves()
    own = (half.across != OUTSIDE) & (half.cell < half.across)
    one, edges = _joined(sub, np.stack([half.cell, half.across], axis=1), np.flatnonzero(own))
    blocks = np.stack([half.cell[one], half.across[one]], axis=1)
    return Contacts(blocks=blocks, joint_set=sub.joint_set[sub.line[half.edge[one]]], **edges)


def boundary(sub: Subdivision) -> BoundaryEdges:
    """Return the edges of blocks on the boundary; side : 0 for the outer one, 1 + k for opening
    k."""
    half = sub.halves()
    side, line = sub.side[half.edge], sub.line[half.edge]
    outer = np.flatnonzero(half.across == OUTSIDE)
    one, edges = _joined(sub, np.stack([half.cell, side, line], axis=1), outer)
    along = sub.along[half.edge[one]]
    return BoundaryEdges(block=half.cell[one], side=side[one], joint_set=along, **edges)


def _joined(
    sub: Subdivision, key: np.ndarray, chosen: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return the edges of chosen halves, with those of one key (int array [h, k]), which lie on one
    line, joined, in the order of the keys: one of the halves that each is made of [n], and start
    and end [n, 2], m, normal [n, 2] and length [n], m."""
    half = sub.halves()
    key, outward = key[chosen], half.outward[chosen]
    along = np.stack([-outward[:, 1], outward[:, 0]], axis=1)
    start, end = sub.points[half.start[chosen]], sub.points[half.end[chosen]]
    order = np.lexsort([(start * along).sum(axis=1), *key.T[::-1]])
    new = np.ones(len(order), bool)
    new[1:] = (np.diff(key[order], axis=0) != 0).any(axis=1)
    begins = np.flatnonzero(new)
    first, last = order[begins], order[np.append(begins[1:], len(order))[: len(begins)] - 1]
    length = np.hypot(*(end[last] - start[first]).T)
    edges = {"start": start[first], "end": end[last], "normal": outward[first], "length": length}
    return chosen[first], edges
