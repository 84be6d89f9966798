"""Convex blocks as half-spaces: whether they are convex, and lie apart."""

import numpy as np
from scipy.optimize import linprog

from jointwave.cases.geometry.block_faces import Face, near, near_boxes, vector_areas
from jointwave.cases.geometry.relations import ranges
from jointwave.cases.gmsh_file import MeshError

CHUNK = 20_000  # pairs of blocks that are compared at a time


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
