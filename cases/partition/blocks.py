"""The blocks of a domain in the plane, with their corners: what is solved there reads them."""

from dataclasses import dataclass

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.relations import composed


@dataclass(frozen=True)
class Partition:
    """A domain in the plane cut into convex blocks. Neighbours have indices that are near.

    Attributes
    ----------
    blocks : what all this is of.
    corners : float array [k, 2], m, of one block after the other, counter-clockwise.
    first : int array [n + 1], the first corner of each block.
    sides : names of the sides: left, right, bottom, top, outline, "opening 0", ...
    joint_sets : names of the joint sets, in the order of the scene.
    """

    blocks: Blocks
    corners: np.ndarray
    first: np.ndarray
    sides: tuple[str, ...]
    joint_sets: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number of blocks."""
        return self.blocks.count

    @property
    def area(self) -> np.ndarray:
        """Area of each block [n], m2."""
        return self.blocks.volume

    @property
    def centroid(self) -> np.ndarray:
        """Centroids [n, 2], m."""
        return self.blocks.centroid

    @property
    def polar_moment(self) -> np.ndarray:
        """Second moment of area about the centroid across the plane [n], m4."""
        return np.einsum("nii->n", self.blocks.second_moment)

    @property
    def region(self) -> np.ndarray:
        """Index of the region of rock that holds each block [n], or -1."""
        return self.blocks.body.region

    @property
    def contacts(self) -> Facets:
        """Edges between blocks."""
        return self.blocks.contacts

    @property
    def boundary(self) -> Facets:
        """Edges on the boundary."""
        return self.blocks.boundary

    def corners_of(self, block: int) -> np.ndarray:
        """Return the corners of one block [k, 2], m, counter-clockwise."""
        return self.corners[self.first[block] : self.first[block + 1]]


def plane_partition(
    blocks: Blocks, sides: tuple[str, ...], joint_sets: tuple[str, ...]
) -> Partition:
    """Return blocks in the plane with their corners: vertices at which two facets of a block meet
    that do not lie in one plane."""
    body, half = blocks.body, blocks.body.halves()
    rows, which = composed(np.stack([half.cell, half.facet], axis=1), body.bounds[0])
    order = np.lexsort([rows[:, 1], rows[:, 0]])
    plane = body.plane[half.facet[which[order]]]
    cell, vertex = rows[order[::2]][plane[::2] != plane[1::2]].T
    x = body.vertices[vertex]
    away = x - blocks.centroid[cell]
    order = np.lexsort([np.arctan2(away[:, 1], away[:, 0]), cell])
    first = np.searchsorted(cell, np.arange(blocks.count + 1))
    return Partition(blocks, x[order], first, sides, joint_sets)
