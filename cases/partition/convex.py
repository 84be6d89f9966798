"""Convex polygons that make a convex one, and pieces that are joined as long as they do."""

import numpy as np
import shapely


def union_is_convex(one: np.ndarray, other: np.ndarray, tolerance: float) -> bool:
    """Return whether two convex polygons that share a side make a convex one.

    one, other : corners, or the corners of several that do, float arrays [n, 2], m, in any order.
    """
    hulls = [hull(one), hull(other), hull(np.concatenate([one, other]))]
    areas = [one.area for one in hulls]
    return bool(areas[2] - areas[0] - areas[1] <= tolerance * hulls[2].length)


def hull(points: np.ndarray) -> shapely.Geometry:
    """Return the convex hull of points, float array [n, 2]."""
    return shapely.MultiPoint(points).convex_hull


class ConvexPieces:
    """Convex pieces that touch each other, joined if the result is convex.

    corners : of each piece by its cell, float arrays [n, 2], m.
    """

    def __init__(self, corners: dict[int, np.ndarray], tolerance: float) -> None:
        self.corners, self.tolerance = corners, tolerance
        self.beside: dict[int, dict[int, float]] = {cell: {} for cell in corners}
        self.root = {cell: cell for cell in corners}

    def connect(self, one: int, other: int, length: float) -> None:
        """Add a length (m) to the common boundary of two pieces."""
        for a, b in ((one, other), (other, one)):
            self.beside[a][b] = self.beside[a].get(b, 0.0) + length

    def merged(self, count: int) -> np.ndarray:
        """Join pieces, the thinnest first, each along the longest side that can be; return the cell
        that each of `count` cells has become a part of."""
        while any([self._join(cell) for cell in sorted(self.corners, key=self._thinness)]):
            pass
        root = np.arange(count)
        for cell in self.root:
            root[cell] = self._root_of(cell)
        return root

    def _thinness(self, cell: int) -> tuple[float, int]:
        shape = hull(self.corners[cell])
        return shape.area / shape.length, cell

    def _join(self, cell: int) -> bool:
        """Join a piece to a neighbour and return whether there is one that it fits."""
        if cell not in self.corners:
            return False
        near = self.beside[cell]
        for other in sorted(near, key=lambda piece: (-near[piece], piece)):
            if union_is_convex(self.corners[cell], self.corners[other], self.tolerance):
                self._absorb(cell, other)
                return True
        return False

    def _absorb(self, one: int, other: int) -> None:
        self.corners[one] = np.concatenate([self.corners[one], self.corners.pop(other)])
        self.root[other] = one
        for third, length in self.beside.pop(other).items():
            del self.beside[third][other]
            if third != one:
                self.connect(one, third, length)

    def _root_of(self, cell: int) -> int:
        while self.root[cell] != cell:
            cell = self.root[cell]
        return cell
