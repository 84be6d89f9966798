"""Blocks, contacts and boundary facets as arrays, in one, two or three dimensions."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from jointwave.cases.geometry import measure
from jointwave.cases.geometry.cell_complex import OUTSIDE, Complex

CONVEX = 1e-6  #: tolerated area error, over the area, of an outline of merged facets


@dataclass(frozen=True)
class Facets:
    """Convex plane pieces of block surfaces: contacts of two blocks, or the boundary of one.

    blocks : int array [c, 2], i and j, i < j; on the boundary j is OUTSIDE. Ordered by i, then j.
    normal : float array [c, d], unit vector out of block i.
    area : float array [c], m^(d-1); 1 in one dimension.
    centroid : float array [c, d], m.
    second_moment : float array [c, d, d], m^(d+1), integrals of x_i x_j about the centroid.
    joint_set : int array [c], index of the joint set, or NO_SET for a cut through intact rock;
        indices past the scene's sets are sets of such cuts. On the boundary, the set of a joint
        along it.
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
    outlines: measure.Outlines

    def __len__(self) -> int:
        return len(self.area)

    @property
    def ends(self) -> np.ndarray:
        """Ends of each facet in the plane [c, 2, 2], m, with block i left of the direction."""
        return self.outlines.corners.reshape(-1, 2, 2)

    def of_joints(self, sets: int) -> np.ndarray:
        """Return which facets lie on joints of a scene with this number of sets, bool array [c]."""
        return (self.joint_set >= 0) & (self.joint_set < sets)


@dataclass(frozen=True)
class Blocks:
    """A domain cut into convex blocks, numbered so that neighbours have similar indices.

    body : complex whose cells are the blocks, with the same indices.
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
        """Size of the arrays, bytes."""
        tables = (self, self.body, self.contacts, self.boundary)
        return sum(x.nbytes for one in tables for x in vars(one).values() if hasattr(x, "nbytes"))

    def faces(self, tolerance: float) -> tuple[np.ndarray, np.ndarray, measure.Outlines]:
        """Return the faces of all blocks, in order: block [f], outward unit normal [f, d], outline.
        Coplanar facets of a block are one face. tolerance : m, of collinear vertices."""
        half, plane = self.body.halves(), self.body.plane
        into = self.body.sides[half.facet, 1] == half.cell
        key = np.stack([half.cell, plane[half.facet], into], axis=1)
        first, group, order = _groups(key)
        normal = half.outward[first]
        found = measure.outlines(self.body, half.facet[order], group, normal, tolerance)
        return half.cell[first], normal, found

    @cached_property
    def outlines(self) -> measure.Outlines:
        """Corners of each block in the plane, counter-clockwise."""
        block, normal, edges = self.faces(0.0)
        order = np.lexsort([np.arctan2(normal[:, 1], normal[:, 0]), block])
        first = np.searchsorted(block, np.arange(self.count + 1))
        return measure.Outlines(edges.corners[::2][order], first)


def blocks_of(body: Complex, tolerance: float, in_rows: bool = True) -> Blocks:
    """Return the cells of a complex as blocks, numbered along rows across the domain.

    tolerance : m, below which vertices are collinear. in_rows : False keeps the order of the cells.
    """
    moments, half = measure.facet_moments(body), body.halves()
    m = measure.cell_moments(body, half, moments.of(half.facet))
    order = np.flatnonzero(m.size > 0)
    if in_rows:  # along the longest extent first
        away, size = m.centroid[order] - body.vertices.min(axis=0), m.size[order].mean()
        *axes, last = np.argsort(-np.ptp(body.vertices, axis=0), kind="stable")
        rows = [np.floor(away[:, axis] / size ** (1 / body.dim)) for axis in axes]
        order = order[np.lexsort([away[:, last], *reversed(rows)])]
    number = np.full(body.count + 1, OUTSIDE)
    number[order] = np.arange(len(order))
    body = replace(body, sides=number[body.sides], region=body.region[order], count=len(order))
    i, j = np.sort(body.sides, axis=1).T
    key = np.stack([i, j, body.joint_set], axis=1)
    contacts = _grouped(body, body.inner, key, moments, tolerance)
    into = body.sides[:, 0] == OUTSIDE
    key = np.stack([j, body.side, body.plane, body.joint_set, into], axis=1)
    boundary = _grouped(body, ~body.inner, key, moments, tolerance)
    return Blocks(body, *m.of(order), contacts, boundary)


def _grouped(
    body: Complex, chosen: np.ndarray, key: np.ndarray, moments: measure.Moments, tolerance: float
) -> Facets:
    """Return the chosen facets (bool array [f]), merging those with equal rows of key (int array
    [f, n]), except where these are not convex together. moments : of all facets."""
    facets = np.flatnonzero(chosen)
    first, group, order = _groups(key[facets])
    one, parts = facets[first], facets[order]
    blocks = body.sides[one]
    turned = (blocks[:, 0] == OUTSIDE) | ((blocks[:, 1] != OUTSIDE) & (blocks[:, 0] > blocks[:, 1]))
    normal = np.where(turned[:, None], -1.0, 1.0) * body.normals[body.plane[one]]
    found = Facets(
        np.where(turned[:, None], blocks[:, ::-1], blocks),
        normal,
        *measure.united(moments.of(parts), group, len(one)),
        joint_set=body.joint_set[one],
        side=body.side[one],
        outlines=measure.outlines(body, parts, group, normal, tolerance),
    )
    apart = np.abs(measure.outline_moments(found.outlines).size - found.area) > CONVEX * found.area
    apart &= np.bincount(group, minlength=len(one)) > 1
    if apart.any():
        own = np.full(len(key), -1)
        own[parts] = np.where(apart[group], order, -1)
        return _grouped(body, chosen, np.column_stack([key, own]), moments, tolerance)
    return found


def _groups(key: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Group equal rows of key (int array [m, n]): return one row of each group, the group of each
    sorted row [m], and the sorting order [m]."""
    order = np.lexsort(key.T[::-1])
    new = np.diff(key[order], axis=0, prepend=-2).any(axis=1)
    return order[new], np.cumsum(new) - 1, order
