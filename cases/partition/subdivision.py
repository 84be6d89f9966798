"""A planar subdivision: points, and straight edges with the cell on either side; faults of it.

Every edge exists once, for both of its cells, and so does every point. Whatever is cut or removed,
cells fit together exactly: their areas add up, and each inner edge belongs to two of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

OUTSIDE = -1  #: in place of a cell: beyond the domain, or in an opening
NO_SET = -1  #: in place of a joint set: the boundary, or a cut through intact rock


class PartitionError(ValueError):
    """A domain that is not cut into convex blocks: where in the plane, and the cause.

    key : of what causes it, in the scene.
    """

    def __init__(self, at: np.ndarray | None, cause: str, key: str = "domain") -> None:
        place = "" if at is None else f", near [{at[0]:.6g}, {at[1]:.6g}]"
        self.at, self.cause, self.key = at, cause, key
        super().__init__(f"{cause}{place}")


class Sliver(PartitionError):
    """A block too thin or too pointed to be passed on."""


class NonConvex(PartitionError):
    """A block that is not convex, at an opening or a corner of the outline."""


class Halves(NamedTuple):
    """Each edge once for each cell that it bounds, with the cell on its left: arrays [h].

    edge, cell : indices. start, end : points. outward : float [h, 2], unit normal out of the cell.
    across : the cell on the other side, or OUTSIDE.
    """

    edge: np.ndarray
    cell: np.ndarray
    start: np.ndarray
    end: np.ndarray
    outward: np.ndarray
    across: np.ndarray


@dataclass(frozen=True)
class Subdivision:
    """A domain in cells.

    Attributes
    ----------
    points : float array [p, 2], m.
    ends : int array [e, 2], points that an edge runs from and to.
    cells : int array [e, 2], the cells to its left and right, or OUTSIDE.
    line : int array [e], the direction of an edge in `directions`.
    side : int array [e], of an edge with OUTSIDE: 0 for the outer boundary, 1 + k for opening k.
    along : int array [e], the joint set whose joint lies along such an edge, or NO_SET.
    directions : float array [l, 2], unit vectors. joint_set : int array [l], or NO_SET.
    region : int array [count], the region of rock that holds each cell, or -1.
    count : cells are 0 to count - 1; some may have been removed.
    """

    points: np.ndarray
    ends: np.ndarray
    cells: np.ndarray
    line: np.ndarray
    side: np.ndarray
    along: np.ndarray
    directions: np.ndarray
    joint_set: np.ndarray
    region: np.ndarray
    count: int

    @classmethod
    def of_polygon(cls, corners: np.ndarray) -> Subdivision:
        """Return a convex polygon (float array [n, 2], counter-clockwise) as one cell."""
        n = len(corners)
        at = np.arange(n)
        along = np.roll(corners, -1, axis=0) - corners
        return cls(
            points=corners,
            ends=np.stack([at, np.roll(at, -1)], axis=1),
            cells=np.stack([np.zeros(n, np.int64), np.full(n, OUTSIDE)], axis=1),
            line=at,
            side=np.zeros(n, np.int64),
            along=np.full(n, NO_SET),
            directions=along / np.hypot(*along.T)[:, None],
            joint_set=np.full(n, NO_SET),
            region=np.full(1, -1),
            count=1,
        )

    def halves(self, chosen: np.ndarray | slice = np.s_[:]) -> Halves:
        """Return the edges, or those that are chosen, once for each of their cells."""
        number = np.arange(len(self.ends))[chosen]
        edge = np.concatenate([number, number])
        right = np.repeat([0, 1], len(number))
        kept = self.cells[edge, right] != OUTSIDE
        edge, right = edge[kept], right[kept]
        start, end = self.ends[edge, right], self.ends[edge, 1 - right]
        outward = self._outward(edge, start, end)
        cell, across = self.cells[edge, right], self.cells[edge, 1 - right]
        return Halves(edge, cell, start, end, outward, across)

    def _outward(self, edge: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return the normals to the right of edges, exactly those of their lines."""
        along = self.directions[self.line[edge]]
        chord = self.points[end] - self.points[start]
        sign = np.where((along * chord).sum(axis=1) < 0, -1.0, 1.0)
        return np.stack([sign * along[:, 1], -sign * along[:, 0]], axis=1)

    def centres(self) -> np.ndarray:
        """Return the mean of each cell's corners [count, 2], which lies inside; nan of none."""
        half = self.halves()
        number = np.bincount(half.cell, minlength=self.count)
        sums = [
            np.bincount(half.cell, weights=self.points[half.start, k], minlength=self.count)
            for k in (0, 1)
        ]
        with np.errstate(invalid="ignore"):
            return np.stack(sums, axis=1) / number[:, None]


def removed(sub: Subdivision, cells: np.ndarray, side: int) -> Subdivision:
    """Return a subdivision without some cells (bool array [count]), whose edges to other cells
    become the boundary `side`."""
    gone = np.append(cells, False)  # the last stands for OUTSIDE
    was = gone[sub.cells]
    changed = was.any(axis=1)
    return kept(
        sub,
        cells=np.where(was, OUTSIDE, sub.cells),
        side=np.where(changed, side, sub.side),
        along=np.where(changed, sub.joint_set[sub.line], sub.along),
    )


def joined(sub: Subdivision, root: np.ndarray) -> Subdivision:
    """Return a subdivision whose cells are joined to others: root, int array [count]."""
    return kept(sub, cells=np.append(root, OUTSIDE)[sub.cells])


def kept(sub: Subdivision, **changed: np.ndarray) -> Subdivision:
    """Return a subdivision with arrays of its edges changed, without edges inside of a cell."""
    of_edges = {name: getattr(sub, name) for name in ("ends", "cells", "line", "side", "along")}
    of_edges |= changed
    holds = of_edges["cells"][:, 0] != of_edges["cells"][:, 1]
    return replace(sub, **{name: array[holds] for name, array in of_edges.items()})
