"""Convex blocks by their faces: whether they are convex, lie apart, and what faces share."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from jointwave.cases.geometry.pieces import clipped
from jointwave.cases.geometry.relations import ranges
from jointwave.cases.gmsh_file import MeshError

CHUNK = 20_000  # pairs of blocks that are compared at a time


class Face(NamedTuple):
    """A convex piece of a block's surface: corners [k, d], m, around the normal out of the block;
    the block; the group of joints, or NO_SET; and the plane, numbered over all blocks."""

    corners: np.ndarray
    cell: int
    joint: int
    plane: int


def vector_areas(corners: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Return the normals of polygons, or of edges of the plane to their right, as long as their
    areas, m2, or lengths, m. corners : of one after the other; sizes : how many each has."""
    first = np.cumsum(sizes) - sizes
    if corners.shape[1] == 2:
        x, y = (corners[first + 1] - corners[first]).T
        return np.stack([y, -x], axis=1)
    after = np.arange(1, len(corners) + 1)
    after[first + sizes - 1] = first
    away = corners - np.repeat(corners[first], sizes, axis=0)
    return np.add.reduceat(np.cross(away, away[after]), first) / 2


def near(x: np.ndarray) -> str:
    """Return the place of some points in words."""
    return " near [{}]".format(", ".join(f"{place:.6g}" for place in x.mean(axis=0)))


def off_plane(x: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return the largest distance of points from a plane, m."""
    return float(np.abs((x - point) @ normal).max())


def _outward(corners: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the unit vectors out of a polygon at its edges, in its plane."""
    out = np.cross(np.roll(corners, -1, axis=0) - corners, normal)
    return out / np.linalg.norm(out, axis=1)[:, None]


def is_convex(corners: np.ndarray, normal: np.ndarray, tolerance: float) -> bool:
    """Return whether no corner lies beyond any edge."""
    out = _outward(corners, normal)
    return bool((out @ corners.T <= (out * corners).sum(axis=1)[:, None] + tolerance).all())


class ConvexBlocks:
    """Blocks as half-spaces (normal [f, d], place [f], of all faces) and corners [c, d], in the
    order of the blocks; boxes around them low and high [n, d]."""

    def __init__(self, faces: list[Face], names: list[str], tolerance: float) -> None:
        self.names, self.tolerance = names, tolerance
        self.corners = np.concatenate([one.corners for one in faces])
        self.sizes = np.array([len(one.corners) for one in faces])
        area = vector_areas(self.corners, self.sizes)
        self.normal = area / np.linalg.norm(area, axis=1)[:, None]
        first = np.cumsum(self.sizes) - self.sizes
        self.place = (self.normal * np.add.reduceat(self.corners, first)).sum(axis=1) / self.sizes
        self.cell = np.array([one.cell for one in faces])
        number = np.arange(len(names) + 1)
        self.face = np.searchsorted(self.cell, number)
        self.corner = np.searchsorted(np.repeat(self.cell, self.sizes), number)
        self.low, self.high = (
            at.reduceat(self.corners, self.corner[:-1]) for at in (np.minimum, np.maximum)
        )

    def heights(self, one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the faces of blocks `one`, the number of the pair that each is of, and the least
        and the largest height of the corners of block `other` above it, m."""
        face, pair = ranges(self.face[one], self.face[one + 1])
        cell = other[pair]
        at, row = ranges(self.corner[cell], self.corner[cell + 1])
        height = (self.corners[at] * self.normal[face[row]]).sum(axis=1) - self.place[face[row]]
        first = np.flatnonzero(np.diff(row, prepend=-1))
        return face, pair, np.minimum.reduceat(height, first), np.maximum.reduceat(height, first)

    def check_convex(self) -> None:
        """Raise MeshError for a block that is inverted, flat or not convex."""
        every = np.arange(len(self.names))
        face, _, low, high = self.heights(every, every)
        above, flat = high > self.tolerance, low >= -self.tolerance
        for wrong, cause in (
            (above & flat & (len(self.low[0]) == 3), "has a face turned inwards"),
            (above, "is not convex"),
            (flat, "is flat"),
        ):
            if wrong.any():
                k = face[np.argmax(wrong)]
                at = self.corners[self.sizes[:k].sum() :][: self.sizes[k]]
                raise MeshError(f"{self.names[self.cell[k]]} {cause}{near(at)}")

    def check_apart(self) -> None:
        """Raise MeshError for two blocks that overlap: no plane lies between them."""
        pairs = near_boxes(self.low, self.high, -self.tolerance)
        for some in np.array_split(pairs, 1 + len(pairs) // CHUNK):
            apart = np.zeros(len(some), bool)
            for one, other in (some.T, some.T[::-1]):
                _, pair, low, _ = self.heights(one, other)
                apart[pair[low >= -self.tolerance]] = True
            for i, j in some[~apart]:
                room, middle = self._common_ball(i, j)
                if room > self.tolerance:
                    both = f"{self.names[i]} and {self.names[j]} overlap"
                    raise MeshError(f"{both}{near(middle[None])}")

    def _common_ball(self, *blocks: int) -> tuple[float, np.ndarray]:
        """Return the radius, m, and the middle of the largest ball in all of some blocks."""
        own = np.concatenate([np.arange(self.face[k], self.face[k + 1]) for k in blocks])
        low, high = self.low[blocks[0]], self.high[blocks[0]]
        size, normal = float((high - low).max()), self.normal[own]
        planes = np.column_stack([np.ones(len(own)), normal])
        places = (self.place[own] - normal @ low) / size  # the solver's accuracy is absolute
        found = linprog([-1.0, *(0.0 * low)], planes, places, bounds=(None, None)).x
        return size * found[0], low + size * found[1:]


def near_boxes(low: np.ndarray, high: np.ndarray, slack: float) -> np.ndarray:
    """Return the pairs of boxes [m, 2] that are less than `slack` (m) apart along every axis."""
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    after = np.searchsorted(low[order, axis], high[order, axis] + slack)
    found = [np.empty((0, 2), np.int64)]
    for k, i in enumerate(order):
        j = order[k + 1 : after[k]]
        j = j[((low[j] < high[i] + slack) & (high[j] > low[i] - slack)).all(axis=1)]
        found.append(np.stack([np.full(len(j), i), j], axis=1))
    return np.concatenate(found)


def overlap(
    x: np.ndarray, by: np.ndarray, normal: np.ndarray, tolerance: float
) -> tuple[np.ndarray | None, list[np.ndarray]]:
    """Return what a convex polygon [k, 3] shares with another one of its plane, and convex pieces
    of the rest; None and the polygon where they share no area."""
    inside, rest = x, []
    for point, out in zip(by, _outward(by, normal), strict=True):
        away = (inside - point) @ out
        if away.max() <= tolerance:
            continue
        if away.min() >= -tolerance:
            return None, [x]
        away[np.abs(away) <= tolerance] = 0.0  # on the line
        rest.append(clipped(inside, away))
        inside = clipped(inside, -away)
    long = float(np.linalg.norm(np.ptp(inside, axis=0)))
    (area,) = vector_areas(inside, np.array([len(inside)]))
    return (inside, rest) if np.linalg.norm(area) > long * tolerance else (None, [x])
