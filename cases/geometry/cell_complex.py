"""A cell complex: vertices, edges, faces and cells that fit together exactly, in any dimension.

A k-cell is the list of the (k-1)-cells that bound it. Each cell is stored once and shared by all
cells that it bounds, so volumes add up after every cut, and an inner facet belongs to two cells.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import placed
from jointwave.cases.geometry.relations import composed, distinct, merged, sums

OUTSIDE = -1  #: instead of a cell index: outside the domain, or in an opening
NO_SET = -1  #: instead of a joint set index: the boundary, or a cut through intact rock
GENERIC = np.array([0.5488, 0.7152, 0.4332])  # unlikely to lie in a plane of a scene
PARALLEL = 1e-12  #: sine of the angle below which planes share one normal


class GeometryError(ValueError):
    """A domain that cannot be cut into convex blocks: `at` a place, `cause`, `key` of the scene."""

    def __init__(self, at: np.ndarray | None, cause: str, key: str = "domain") -> None:
        place = "" if at is None else f", near {placed(at)}"
        self.at, self.cause, self.key = at, cause, key
        super().__init__(f"{cause}{place}")


class Sliver(GeometryError):
    """A block that is too thin or too pointed to keep."""


class Halves(NamedTuple):
    """Half-facets: facets listed once for each cell that they bound, int arrays [h]. facet, cell :
    indices. across : cell on the other side, or OUTSIDE. outward : unit normal out of the cell [h,
    d]."""

    facet: np.ndarray
    cell: np.ndarray
    across: np.ndarray
    outward: np.ndarray


@dataclass(frozen=True)
class Complex:
    """Convex cells of a domain in d dimensions, with their facets of d - 1 dimensions.

    vertices : float array [v, d], m.
    bounds : for k = 1 to d - 1, pairs of a k-cell and a (k-1)-cell that bounds it, int arrays [m,
        2] sorted by the k-cell: the ends of edges, then the edges of faces.
    sides : int array [f, 2], the cells that the facet's normal points out of and into, or OUTSIDE.
    plane : int array [f], index of the facet's normal in `normals`. Facets of one cell with the
        same normal lie in one plane on each side of the cell, since cells are convex.
    joint_set : int array [f], the set whose joint the facet lies on, or NO_SET.
    side : int array [f], for boundary facets: 0 for the outer boundary, 1 + k for opening k.
    normals : float array [l, d], unit vectors, no two of them parallel.
    region : int array [count], region of rock of each cell, or -1.
    count : cells are numbered 0 to count - 1; some may have been removed.
    """

    vertices: np.ndarray
    bounds: tuple[np.ndarray, ...]
    sides: np.ndarray
    plane: np.ndarray
    joint_set: np.ndarray
    side: np.ndarray
    normals: np.ndarray
    region: np.ndarray
    count: int

    @property
    def dim(self) -> int:
        """Number of dimensions."""
        return self.vertices.shape[1]

    def numbers(self) -> list[int]:
        """Return the number of k-cells for k = 0 to d."""
        edges = [len(self.bounds[0]) // 2] if self.dim == 3 else []
        vertices = [len(self.vertices)] if self.dim > 1 else []
        return [*vertices, *edges, len(self.sides), self.count]

    @property
    def inner(self) -> np.ndarray:
        """Which facets lie between two cells, bool array [f]."""
        return (self.sides != OUTSIDE).all(axis=1)

    @property
    def in_rock(self) -> np.ndarray:
        """Which facets lie between two cells of one region, bool array [f]."""
        one, other = self.region[self.sides].T
        return self.inner & (one == other)

    def halves(self, chosen: np.ndarray | slice = np.s_[:]) -> Halves:
        """Return the half-facets of all facets, or of the chosen ones."""
        number = np.arange(len(self.sides))[chosen]
        facet, into = np.tile(number, 2), np.repeat([0, 1], len(number))
        held = self.sides[facet, into] != OUTSIDE
        facet, into = facet[held], into[held]
        outward = self.normals[self.plane[facet]] * (1 - 2 * into)[:, None]
        return Halves(facet, self.sides[facet, into], self.sides[facet, 1 - into], outward)

    def beside(self, cells: np.ndarray) -> Halves:
        """Return the half-facets of some cells, bool array [count]."""
        near = np.append(cells, False)[self.sides].any(axis=1)
        half = self.halves(near)
        return Halves(*(array[cells[half.cell]] for array in half))

    def vertices_of(self, pairs: np.ndarray) -> np.ndarray:
        """Return sorted pairs (x, vertex) from pairs (x, facet), int arrays [m, 2]."""
        for bound in reversed(self.bounds):
            pairs = distinct(composed(pairs, bound)[0])
        return distinct(pairs)

    def corners(self, half: Halves) -> np.ndarray:
        """Return the distinct pairs (cell, vertex) of half-facets, int array [m, 2], sorted."""
        return self.vertices_of(np.stack([half.cell, half.facet], axis=1))

    def corners_of_facets(self) -> np.ndarray:
        """Return the distinct pairs (facet, vertex) of all facets, int array [m, 2], sorted."""
        number = np.arange(len(self.sides))
        return self.vertices_of(np.stack([number, number], axis=1))

    def centres(self, half: Halves | None = None) -> np.ndarray:
        """Return the mean vertex of each cell [count, d], m, an inner point; NaN if removed."""
        return self.means(self.corners(half or self.halves()), self.count)

    def means(self, pairs: np.ndarray, number: int) -> np.ndarray:
        """Return the mean vertex of each owner [number, d], m; NaN for an owner without vertices.

        pairs : int array [m, 2], owner and vertex.
        """
        owner, vertex = pairs.T
        with np.errstate(invalid="ignore"):
            times = np.bincount(owner, minlength=number)[:, None]
            return sums(owner, self.vertices[vertex], number) / times

    def extents(self, half: Halves, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the least and the largest value of x over each cell's vertices [count, ...]; (inf,
        -inf) for cells without half-facets. x : values at all vertices [v, ...]."""
        cell, vertex = self.corners(half).T
        begins = np.flatnonzero(np.diff(cell, prepend=-1))
        low, high = (np.full((self.count, *x.shape[1:]), one) for one in (np.inf, -np.inf))
        if len(begins):
            low[cell[begins]] = np.minimum.reduceat(x[vertex], begins)
            high[cell[begins]] = np.maximum.reduceat(x[vertex], begins)
        return low, high

    def places(self, half: Halves) -> np.ndarray:
        """Return the signed distance of each half-facet's plane from the origin [h], m."""
        first = half.facet
        for bound in reversed(self.bounds):
            first = bound[np.searchsorted(bound[:, 0], first), 1]
        return (self.vertices[first] * half.outward).sum(axis=1)

    def depths(self, point: np.ndarray) -> np.ndarray:
        """Return the depth of a point [d] in each cell [count], m; < 0 outside, -inf if removed."""
        half, depth = self.halves(), np.full(self.count, np.inf)
        np.minimum.at(depth, half.cell, self.places(half) - half.outward @ point)
        return np.where(np.isinf(depth), -np.inf, depth)

    def removed(self, cells: np.ndarray, side: int) -> "Complex":
        """Return the complex without some cells (bool array [count]); the facets they shared with
        other cells become the boundary `side`."""
        was = np.append(cells, False)[self.sides]  # the last stands for OUTSIDE
        return replace(
            self,
            sides=np.where(was, OUTSIDE, self.sides),
            side=np.where(was.any(axis=1), side, self.side),
        )._without_inner()

    def joined(self, root: np.ndarray) -> "Complex":
        """Return the complex with cells merged; root : int array [count], the cell each joins."""
        return replace(self, sides=np.append(root, OUTSIDE)[self.sides])._without_inner()

    def _without_inner(self) -> "Complex":
        """Return the complex without facets that have the same cell on both sides."""
        held = self.sides[:, 0] != self.sides[:, 1]
        bounds = self.bounds
        if bounds:
            number, last = np.cumsum(held) - 1, bounds[-1][held[bounds[-1][:, 0]]]
            last = np.stack([number[last[:, 0]], last[:, 1]], axis=1)
            bounds = (*bounds[:-1], last)
        own = {key: getattr(self, key)[held] for key in ("sides", "plane", "joint_set", "side")}
        return replace(self, bounds=bounds, **own)

    def with_normal(self, normal: np.ndarray) -> tuple[np.ndarray, int, bool]:
        """Return `normals`, extended by the normal if none is parallel to it; its index; and
        whether the existing one has the opposite sense."""
        cosine = self.normals @ normal
        away = np.linalg.norm(normal - cosine[:, None] * self.normals, axis=1)
        if (away <= PARALLEL).any():
            index = int(np.argmin(away))
            return self.normals, index, bool(cosine[index] < 0)
        return np.concatenate([self.normals, normal[None]]), len(self.normals), False


def from_facets(
    x: np.ndarray, loops: Sequence[Sequence[int]], sides: np.ndarray, normal: np.ndarray
) -> Complex:
    """Return the complex of facets given as loops of vertices in order.

    x : float array [v, d], m. sides : int array [n, 2], cells that normals [n, d] leave and enter.
    """
    turned = (normal @ GENERIC[: x.shape[1]] < 0)[:, None]
    normals, plane = np.unique(
        merged(np.where(turned, -normal, normal), PARALLEL), return_inverse=True
    )
    plane, normals = plane.reshape(-1), normal[normals]
    turned = (normal * normals[plane]).sum(axis=1) < 0
    used, vertex = np.unique(np.concatenate(loops), return_inverse=True)
    vertex, size = vertex.reshape(-1), np.array(list(map(len, loops)))
    facet, bounds = np.repeat(np.arange(len(loops)), size), []
    if x.shape[1] == 2:
        bounds = [np.stack([facet, vertex], axis=1)]
    elif x.shape[1] == 3:
        after = np.arange(1, len(vertex) + 1)
        after[np.cumsum(size) - 1] = np.cumsum(size) - size
        steps = np.sort(np.stack([vertex, vertex[after]], axis=1), axis=1)
        edges, edge = np.unique(steps, axis=0, return_inverse=True)
        bounds = [np.stack([np.repeat(np.arange(len(edges)), 2), edges.ravel()], axis=1)]
        bounds.append(np.stack([facet, edge.reshape(-1)], axis=1))
    return Complex(
        vertices=x[used],
        bounds=tuple(bounds),
        sides=np.where(turned[:, None], sides[:, ::-1], sides),
        plane=plane,
        joint_set=np.full(len(sides), NO_SET),
        side=np.zeros(len(sides), np.int64),
        normals=normals,
        region=np.full(sides.max() + 1, -1),
        count=int(sides.max()) + 1,
    )


def box(low: np.ndarray, high: np.ndarray) -> Complex:
    """Return an axis-parallel box as one cell; low, high : its corners, float arrays [d], m."""
    dim = len(low)
    x = np.array(list(product(*zip(low, high, strict=True))), dtype=float)
    corner = np.arange(2**dim).reshape((2,) * dim)
    ends = [np.take(corner, end, axis).ravel() for axis in range(dim) for end in (0, 1)]
    loops = [one[[0, 1, 3, 2]] if dim == 3 else one for one in ends]
    outward = np.repeat(np.eye(dim), 2, axis=0)
    sides = np.tile([[OUTSIDE, 0], [0, OUTSIDE]], (dim, 1))
    return from_facets(x, loops, sides, outward)


def polygon(corners: np.ndarray) -> Complex:
    """Return a convex polygon (float array [n, 2], m, counter-clockwise) as one cell."""
    n, along = len(corners), np.roll(corners, -1, axis=0) - corners
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    loops = [[k, (k + 1) % n] for k in range(n)]
    return from_facets(corners, loops, np.tile([0, OUTSIDE], (n, 1)), outward)
