"""Blocks, contacts and boundary edges as plain arrays, the input of engines."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Contacts:
    """Straight edges that two blocks share, one for each pair of blocks that touch.

    Attributes
    ----------
    blocks : int array [c, 2], i < j, ordered by i and then j.
    start, end : float arrays [c, 2], m; block i lies to the left on the way.
    normal : float array [c, 2], unit vector from block i to block j, that of the joint set.
    length : float array [c], m.
    joint_set : int array [c], index of the joint set, or NO_SET for a cut through intact rock;
        beyond the sets of the scene that of a set of such cuts.
    """

    blocks: np.ndarray
    start: np.ndarray
    end: np.ndarray
    normal: np.ndarray
    length: np.ndarray
    joint_set: np.ndarray

    def __len__(self) -> int:
        return len(self.length)

    def of_joints(self, sets: int) -> np.ndarray:
        """Return which lie on joints of a scene with this number of sets, bool array [c]."""
        return (self.joint_set >= 0) & (self.joint_set < sets)


@dataclass(frozen=True)
class BoundaryEdges:
    """Straight edges of blocks on the domain's boundary.

    Attributes
    ----------
    block : int array [b], ordered.
    start, end : float arrays [b, 2], m; the block lies to the left on the way.
    normal : float array [b, 2], unit vector out of the block.
    length : float array [b], m.
    side : int array [b], index in the partition's `sides`.
    joint_set : int array [b], index of the set whose joint lies along the edge, or NO_SET.
    """

    block: np.ndarray
    start: np.ndarray
    end: np.ndarray
    normal: np.ndarray
    length: np.ndarray
    side: np.ndarray
    joint_set: np.ndarray

    def __len__(self) -> int:
        return len(self.length)


@dataclass(frozen=True)
class Partition:
    """A domain cut into convex blocks. Neighbours have indices that are near each other.

    Attributes
    ----------
    corners : float array [k, 2], m, of one block after the other, counter-clockwise.
    first : int array [n + 1], the first corner of each block.
    area : float array [n], m2. centroid : float array [n, 2], m.
    second_moment : float array [n, 3], m4, integrals of x x, y y and x y about the centroid.
    region : int array [n], index of the region of rock that holds a block, or -1.
    contacts : between blocks. boundary : edges on the boundary.
    sides : names of the sides: left, right, bottom, top, outline, "opening 0", ...
    joint_sets : names of the joint sets, in the order of the scene.
    """

    corners: np.ndarray
    first: np.ndarray
    area: np.ndarray
    centroid: np.ndarray
    second_moment: np.ndarray
    region: np.ndarray
    contacts: Contacts
    boundary: BoundaryEdges
    sides: tuple[str, ...]
    joint_sets: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.area)

    @property
    def polar_moment(self) -> np.ndarray:
        """Second moment of area about the centroid across the plane [n], m4."""
        return self.second_moment[:, 0] + self.second_moment[:, 1]

    def corners_of(self, block: int) -> np.ndarray:
        """Return the corners of one block [k, 2], m, counter-clockwise."""
        return self.corners[self.first[block] : self.first[block + 1]]

    @property
    def nbytes(self) -> int:
        """Bytes that the arrays take."""
        tables = (vars(self), vars(self.contacts), vars(self.boundary))
        return sum(x.nbytes for table in tables for x in table.values() if hasattr(x, "nbytes"))
