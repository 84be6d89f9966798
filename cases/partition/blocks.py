"""Blocks, contacts and boundary edges in the plane as plain arrays, the input of engines."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.relations import composed
from jointwave.cases.schema.joint_set import JointSet


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
    blocks : what all this is made of.
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
    blocks: Blocks

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.area)

    @property
    def polar_moment(self) -> np.ndarray:
        """Second moment of area about the centroid across the plane [n], m4."""
        return self.second_moment[:, 0] + self.second_moment[:, 1]

    @property
    def owner(self) -> np.ndarray:
        """The block of each corner, int array [k]."""
        return np.repeat(np.arange(self.count), np.diff(self.first))

    def corners_of(self, block: int) -> np.ndarray:
        """Return the corners of one block [k, 2], m, counter-clockwise."""
        return self.corners[self.first[block] : self.first[block + 1]]


def plane_contacts(facets: Facets) -> Contacts:
    """Return contacts in the plane, with their ends."""
    ends = facets.outlines.corners.reshape(-1, 2, 2)
    return Contacts(
        blocks=facets.blocks,
        start=ends[:, 0],
        end=ends[:, 1],
        normal=facets.normal,
        length=facets.area,
        joint_set=facets.joint_set,
    )


def plane_partition(
    blocks: Blocks, sides: tuple[str, ...], joint_sets: Sequence[JointSet]
) -> Partition:
    """Return the arrays of blocks in the plane; boundary edges have the sides of their facets."""
    corners, first = _rings(blocks)
    outer, second = blocks.boundary, blocks.second_moment
    ends = outer.outlines.corners.reshape(-1, 2, 2)
    return Partition(
        corners=corners,
        first=first,
        area=blocks.volume,
        centroid=blocks.centroid,
        second_moment=np.stack([second[:, 0, 0], second[:, 1, 1], second[:, 0, 1]], axis=1),
        region=blocks.body.region,
        contacts=plane_contacts(blocks.contacts),
        boundary=BoundaryEdges(
            block=outer.blocks[:, 0],
            start=ends[:, 0],
            end=ends[:, 1],
            normal=outer.normal,
            length=outer.area,
            side=outer.side,
            joint_set=outer.joint_set,
        ),
        sides=sides,
        joint_sets=tuple(one.name for one in joint_sets),
        blocks=blocks,
    )


def _rings(blocks: Blocks) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of all blocks in the plane, counter-clockwise, m, and the first corner of
    each: vertices at which two facets of a block meet that do not lie in one plane."""
    body, half = blocks.body, blocks.body.halves()
    rows, which = composed(np.stack([half.cell, half.facet], axis=1), body.bounds[0])
    order = np.lexsort([rows[:, 1], rows[:, 0]])
    plane = body.plane[half.facet[which[order]]]
    cell, vertex = rows[order[::2]][plane[::2] != plane[1::2]].T
    x = body.vertices[vertex]
    away = x - blocks.centroid[cell]
    order = np.lexsort([np.arctan2(away[:, 1], away[:, 0]), cell])
    return x[order], np.searchsorted(cell, np.arange(blocks.count + 1))
