"""Blocks, contacts and boundary facets as arrays, in one, two or three dimensions."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from jointwave.cases.geometry.cell_complex import OUTSIDE, Complex
from jointwave.cases.geometry.measure import (
    Moments,
    Outlines,
    cell_moments,
    facet_moments,
    outline_moments,
    outlines,
    united,
)

CONVEX = 1e-6  #: of its area: what the outline of facets may lack that are together convex


@dataclass(frozen=True)
class Facets:
    """Plane convex pieces of the surfaces of blocks: contacts of two, or the boundary of one.

    Attributes
    ----------
    blocks : int array [c, 2], i and j, i < j; for the boundary j is OUTSIDE. Ordered by i, then j.
    normal : float array [c, d], unit vector out of block i.
    area : float array [c], m^(d-1); 1 in one dimension.
    centroid : float array [c, d], m.
    second_moment : float array [c, d, d], m^(d+1), integrals of x_i x_j about the centroid.
    joint_set : int array [c], index of the joint set, or NO_SET for a cut through intact rock;
        beyond the sets of the scene that of a set of such cuts. On the boundary the set whose
        joint lies along it.
    side : int array [c], of the boundary: 0 for the outer one, 1 + k for opening k.
    outlines : corners around the normal.
    """

    blocks: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    centroid: np.ndarray
    second_moment: np.ndarray
    joint_set: np.ndarray
    side: np.ndarray
    outlines: Outlines

    def __len__(self) -> int:
        return len(self.area)

    @property
    def ends(self) -> np.ndarray:
        """In the plane the ends of each [c, 2, 2], m: to the second block i lies to the left."""
        return self.outlines.corners.reshape(-1, 2, 2)

    def of_joints(self, sets: int) -> np.ndarray:
        """Return which lie on joints of a scene with this number of sets, bool array [c]."""
        return (self.joint_set >= 0) & (self.joint_set < sets)


@dataclass(frozen=True)
class Blocks:
    """A domain cut into convex blocks. Neighbours have indices that are near each other.

    Attributes
    ----------
    body : the cells that the blocks are, with the same indices.
    volume : float array [n], m^d. centroid : float array [n, d], m.
    second_moment : float array [n, d, d], m^(d+2), integrals of x_i x_j about the centroid.
    contacts : between blocks. boundary : on the boundary of the domain and of openings.
    """

    body: Complex
    volume: np.ndarray
    centroid: np.ndarray
    second_moment: np.ndarray
    contacts: Facets
    boundary: Facets

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.volume)

    @property
    def nbytes(self) -> int:
        """Bytes that the arrays take."""
        tables = (self, self.body, self.contacts, self.boundary)
        return sum(x.nbytes for one in tables for x in vars(one).values() if hasattr(x, "nbytes"))

    def faces(self, tolerance: float) -> tuple[np.ndarray, np.ndarray, Outlines]:
        """Return the faces of all blocks, in order: the block of each [f], its unit normal out of
        that [f, d], and its outline. Coplanar facets of a block are one face.

        tolerance : m, below which vertices lie in a line.
        """
        half, plane = self.body.halves(), self.body.plane
        into = self.body.sides[half.facet, 1] == half.cell
        key = np.stack([half.cell, plane[half.facet], into], axis=1)
        first, group, order = _groups(key)
        normal = half.outward[first]
        found = outlines(self.body, half.facet[order], group, normal, tolerance)
        return half.cell[first], normal, found

    @cached_property
    def outlines(self) -> Outlines:
        """In the plane the corners of each block, counter-clockwise."""
        block, normal, edges = self.faces(0.0)
        order = np.lexsort([np.arctan2(normal[:, 1], normal[:, 0]), block])
        first = np.searchsorted(block, np.arange(self.count + 1))
        return Outlines(edges.corners[::2][order], first)


def blocks_of(body: Complex, tolerance: float, in_rows: bool = True) -> Blocks:
    """Return the cells of a complex as blocks, numbered along rows across the domain.

    tolerance : m, below which vertices lie in a line. in_rows : False numbers them as the cells.
    """
    moments = facet_moments(body)
    half = body.halves()
    m = cell_moments(body, half, Moments(*(array[half.facet] for array in moments)))
    order = _in_rows(body, m) if in_rows else np.flatnonzero(m.size > 0)
    number = np.full(body.count + 1, OUTSIDE)
    number[order] = np.arange(len(order))
    body = replace(body, sides=number[body.sides], region=body.region[order], count=len(order))
    inner, outer = np.flatnonzero(body.inner), np.flatnonzero(~body.inner)
    i, j = np.sort(body.sides[inner], axis=1).T
    key = np.stack([i, j, body.joint_set[inner]], axis=1)
    contacts = _grouped(body, inner, key, moments, tolerance)
    block, into = body.sides[outer].max(axis=1), body.sides[outer, 0] == OUTSIDE
    key = np.stack(
        [block, body.side[outer], body.plane[outer], body.joint_set[outer], into], axis=1
    )
    boundary = _grouped(body, outer, key, moments, tolerance)
    own = Moments(*(array[order] for array in m))
    return Blocks(body, own.size, own.centroid, own.second, contacts, boundary)


def _in_rows(body: Complex, m: Moments) -> np.ndarray:
    """Return the cells that there are, int array, in rows, along the longest extent first."""
    used = np.flatnonzero(m.size > 0)
    away = m.centroid[used] - body.vertices.min(axis=0)
    size = m.size[used].mean() ** (1 / body.dim)
    axes = np.argsort(-np.ptp(body.vertices, axis=0), kind="stable")
    rows = [np.floor(away[:, axis] / size) for axis in axes[:-1]]
    return used[np.lexsort([away[:, axes[-1]], *reversed(rows)])]


def _grouped(
    body: Complex, facets: np.ndarray, key: np.ndarray, moments: Moments, tolerance: float
) -> Facets:
    """Return facets, those of one key (int array [m, n]) as one piece; moments : of all facets."""
    first, group, order = _groups(key)
    found = _united(body, facets, first, group, order, moments, tolerance)
    size = outline_moments(found.outlines).size
    apart = np.abs(size - found.area) > CONVEX * found.area
    if apart.any():  # what is left beside others of a face need not be convex, nor in one piece
        own = np.empty(len(facets), np.int64)
        own[order] = np.where(apart[group], order, -1)
        first, group, order = _groups(np.column_stack([key, own]))
        return _united(body, facets, first, group, order, moments, tolerance)
    return found


def _united(
    body: Complex,
    facets: np.ndarray,
    first: np.ndarray,
    group: np.ndarray,
    order: np.ndarray,
    moments: Moments,
    tolerance: float,
) -> Facets:
    """Return facets, those of one group as one piece; for groups see `_groups`."""
    one = facets[first]
    blocks = body.sides[one]
    turned = (blocks[:, 0] == OUTSIDE) | ((blocks[:, 1] != OUTSIDE) & (blocks[:, 0] > blocks[:, 1]))
    blocks = np.where(turned[:, None], blocks[:, ::-1], blocks)
    normal = np.where(turned[:, None], -1.0, 1.0) * body.normals[body.plane[one]]
    parts = Moments(*(array[facets[order]] for array in moments))
    m = united(parts, group, len(first))
    return Facets(
        blocks=blocks,
        normal=normal,
        area=m.size,
        centroid=m.centroid,
        second_moment=m.second,
        joint_set=body.joint_set[one],
        side=body.side[one],
        outlines=outlines(body, facets[order], group, normal, tolerance),
    )


def _groups(key: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the groups of rows that are alike (int array [m, n]), in the order of the rows: one
    row of each, the group of each row [m], in order, and the rows in that order [m]."""
    order = np.lexsort(key.T[::-1])
    new = np.diff(key[order], axis=0, prepend=-2).any(axis=1)
    return order[new], np.cumsum(new) - 1, order
