"""Volume, centroid and second moments of cells, and outlines of facets, in any dimension.

Facets are fans of simplices from one of their vertices; cells are cones over their facets. A
k-simplex with corners v has the second moment V / ((k + 1) (k + 2)) (sum v v + sum v sum v) about
the origin.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, Halves
from jointwave.cases.geometry.relations import composed, counted, distinct, sums

LEVEL = 1e-9  # round-off in the components of a unit normal


class Moments(NamedTuple):
    """Volume or area [n], m^k; centroid [n, d], m; second moment about the centroid [n, d, d], m^(k
    + 2), the integrals of x_i x_j."""

    size: np.ndarray
    centroid: np.ndarray
    second: np.ndarray

    def of(self, rows: np.ndarray) -> "Moments":
        """Return the moments of some rows, int array."""
        return Moments(self.size[rows], self.centroid[rows], self.second[rows])


def facet_moments(body: Complex, facets: np.ndarray | None = None) -> Moments:
    """Return the moments of some facets, int array [n], or of all."""
    facets = np.arange(len(body.sides)) if facets is None else facets
    number, ends = np.arange(len(facets)), min(body.dim, 2)
    pairs = np.stack([number, facets], axis=1)
    for bound in reversed(body.bounds):
        pairs = composed(pairs, bound)[0]
    x, which = body.vertices[pairs[:, 1]].reshape(-1, ends, body.dim), pairs[::ends, 0]
    first = np.searchsorted(which, number)
    if body.dim == 3:  # triangles of an edge and the facet's first vertex
        x = np.concatenate([x, x[first[which], :1]], axis=1)
    return _of_simplices(x, which, x[first, -1])


def cell_moments(
    body: Complex, half: Halves | None = None, facets: Moments | None = None
) -> Moments:
    """Return the moments of all cells as cones over their facets; removed cells have volume 0.

    half : half-facets, all where absent. facets : moments of each half-facet.

    A cone of height h over a facet of size A, f from its apex to the facet's centroid, S the
    facet's second moment, has A h / d, A h f / (d + 1) and h (S + A f f) / (d + 2) about its apex.
    """
    half = half or body.halves()
    facets = facets or facet_moments(body, half.facet)
    centre = body.centres(half)
    away = facets.centroid - centre[half.cell]
    height, dim = (away * half.outward).sum(axis=1), body.dim
    size = facets.size * height
    second = size[:, None, None] * away[:, :, None] * away[:, None]
    second += height[:, None, None] * facets.second
    parts = Moments(size / dim, size[:, None] * away / (dim + 1), second / (dim + 2))
    return _about_centroids(parts, half.cell, centre)


def united(parts: Moments, owner: np.ndarray, number: int) -> Moments:
    """Return the moments of unions of parts; owner : int array [m], the union of each part."""
    about = np.zeros((number, parts.centroid.shape[1]))
    about[owner[::-1]] = parts.centroid[::-1]
    away = parts.centroid - about[owner]
    moment = parts.size[:, None] * away
    second = parts.second + moment[:, :, None] * away[:, None]
    return _about_centroids(Moments(parts.size, moment, second), owner, about)


def _about_centroids(parts: Moments, owner: np.ndarray, about: np.ndarray) -> Moments:
    """Return the moments of unions from the sizes of parts and the parts' first and second moments
    about a point of each union [n, d], m."""
    whole, first, second = (sums(owner, one, len(about)) for one in parts)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = first / whole[:, None]
    second = second - whole[:, None, None] * centre[:, :, None] * centre[:, None]
    return Moments(whole, about + centre, second)


def _of_simplices(x: np.ndarray, owner: np.ndarray, about: np.ndarray) -> Moments:
    """Return the moments of unions of points, segments or triangles x [m, k + 1, d], m; owner :
    [m], union of each; about : a point of each union [n, d], m."""
    k, edges = x.shape[1] - 1, x[:, 1:] - x[:, :1]
    size = np.linalg.norm(edges[:, 0], axis=1) if k else np.ones(len(x))
    if k == 2:
        size = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2
    x = x - about[owner][:, None]
    total = x.sum(axis=1)
    second = np.einsum("mki,mkj->mij", x, x) + total[:, :, None] * total[:, None]
    second *= (size / ((k + 1) * (k + 2)))[:, None, None]
    return _about_centroids(Moments(size, size[:, None] * total / (k + 1), second), owner, about)


class Outlines(NamedTuple):
    """Convex plane pieces as lists of corners around their normals.

    corners : float array [k, d], m. first : int array [n + 1], the first corner of each piece. In
    the plane a piece is a segment, directed so that the normal points to its right.
    """

    corners: np.ndarray
    first: np.ndarray

    def of(self, k: int) -> np.ndarray:
        """Return the corners of piece k [n, d], m."""
        return self.corners[self.first[k] : self.first[k + 1]]


def outlines_of(pieces: Sequence[np.ndarray]) -> Outlines:
    """Return outlines from the corners of each piece [n, d], m."""
    return Outlines(np.concatenate(pieces), np.append(0, np.cumsum(list(map(len, pieces)))))


def joined(parts: Sequence[Outlines]) -> Outlines:
    """Return the pieces of several outlines in one."""
    sizes = np.concatenate([np.diff(one.first) for one in parts])
    return Outlines(np.concatenate([one.corners for one in parts]), np.append(0, np.cumsum(sizes)))


def outline_moments(pieces: Outlines) -> Moments:
    """Return the moments of pieces, each a fan of simplices from its first corner."""
    x, first = pieces
    size, dim = np.diff(first), x.shape[1]
    owner = np.repeat(np.arange(len(size)), np.maximum(size - (dim - 1), 0))
    at = np.arange(len(owner)) - np.searchsorted(owner, owner)
    corners = [x[first[:-1][owner] + (at + k if k else 0)] for k in range(dim)]
    return _of_simplices(np.stack(corners, axis=1), owner, x[first[:-1]])


def outlines(
    body: Complex, facets: np.ndarray, group: np.ndarray, normal: np.ndarray, tolerance: float
) -> Outlines:
    """Return the outlines of groups of facets, each plane and convex.

    facets, group : int arrays [m], sorted by group. normal : float array [n, d], of each group.
    """
    pairs = np.stack([group, facets], axis=1)
    if body.dim > 1:
        pairs, times = counted(composed(pairs, body.bounds[-1])[0])
        pairs = pairs[times == 1]
        for bound in reversed(body.bounds[:-1]):
            pairs = distinct(composed(pairs, bound)[0])
    return around(body.vertices[pairs[:, 1]], pairs[:, 0], normal, tolerance)


def around(x: np.ndarray, of: np.ndarray, normal: np.ndarray, tolerance: float) -> Outlines:
    """Return convex pieces from their unordered corners, float array [m, d], m.

    of : int array [m], sorted, the piece of each corner. normal : float array [n, d], of each
    piece. In space without corners within the tolerance (m) of the line between their neighbours.
    """
    number, dim = len(normal), x.shape[1]
    if dim == 2:
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)[of]
        order = np.lexsort([(x * along).sum(axis=1), of])
    elif dim == 3:
        one, other = frames(normal)
        away = x - (sums(of, x, number) / np.bincount(of, minlength=number)[:, None])[of]
        u, v = (away * one[of]).sum(axis=1), (away * other[of]).sum(axis=1)
        order = np.lexsort([np.arctan2(v, u), of])
    else:
        order = np.arange(len(x))
    x, of = x[order], of[order]
    first = np.searchsorted(of, np.arange(number + 1))
    if dim < 3:
        return Outlines(x, first)
    size, at = np.diff(first)[of], np.arange(len(x)) - first[of]
    before, after = (first[of] + (at + step) % size for step in (-1, 1))
    chord = x[after] - x[before]
    along = chord / np.maximum(np.linalg.norm(chord, axis=1), tolerance)[:, None]
    out = x - x[before]
    away = np.linalg.norm(out - (out * along).sum(axis=1)[:, None] * along, axis=1)
    kept = away > tolerance
    return Outlines(x[kept], np.searchsorted(of[kept], np.arange(number + 1)))


def frames(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors [n, 3] that complete normals [n, 3] to right-handed frames; the first
    is horizontal, along the strike, or east in a horizontal plane."""
    strike = np.stack([-normal[:, 1], normal[:, 0], np.zeros(len(normal))], axis=1)
    length = np.linalg.norm(strike, axis=1)[:, None]
    one = np.where(length > 1e-12, strike / np.maximum(length, 1e-12), [[1.0, 0.0, 0.0]])
    return one, np.cross(normal, one)


def frames_of(normal: np.ndarray) -> np.ndarray:
    """Return contact frames [c, d, d] from normals [c, d]: normal, then in the plane the normal
    rotated to the left, in space the directions of strike and dip."""
    tangents: tuple[np.ndarray, ...] = ()
    if (dim := normal.shape[1]) == 2:
        tangents = (np.stack([-normal[:, 1], normal[:, 0]], axis=1),)
    elif dim == 3:
        tangents = frames(normal)
    return np.stack([normal, *tangents], axis=1)


def upwards(frame: np.ndarray) -> np.ndarray:
    """Return matrices [w, d, d] that turn row vectors of tractions and jumps in joint frames [w, d,
    d] into those of the upper side relative to the lower, in the frame of the upward normal.

    Entries are 0, 1 and -1. A vertical joint's normal points along y, or else along x. In the plane
    the values do not change; in space their sign would otherwise depend on block numbers.
    """
    normal = frame[:, 0]
    last = normal.shape[1] - 1 - (np.abs(normal[:, ::-1]) > LEVEL).argmax(axis=1)
    sign = np.sign(np.take_along_axis(normal, last[:, None], axis=1))
    return np.rint(sign[:, None] * frame @ frames_of(sign * normal).swapaxes(1, 2))


def widths(body: Complex, half: Halves) -> np.ndarray:
    """Return the least width of each cell [count], m: over its facets, the least distance to the
    farthest vertex; infinite for cells without facets."""
    number = np.arange(len(half.cell))
    pairs, which = composed(np.stack([number, half.cell], axis=1), body.corners(half))
    depth = body.places(half)[which]
    depth -= (body.vertices[pairs[:, 1]] * half.outward[which]).sum(axis=1)
    deepest = np.maximum.reduceat(depth, np.flatnonzero(np.diff(which, prepend=-1)))
    found = np.full(body.count, np.inf)
    np.minimum.at(found, half.cell, deepest)
    return found


def least_angles(body: Complex, half: Halves) -> np.ndarray:
    """Return the least angle between facets of each cell [count], degrees; 180 without any."""
    found = np.full(body.count, 180.0)
    if body.dim == 1:
        return found
    rows, which = composed(np.stack([half.cell, half.facet], axis=1), body.bounds[-1])
    order = np.lexsort([rows[:, 1], rows[:, 0]])
    rows, which = rows[order], which[order]
    pair = np.flatnonzero((np.diff(rows, axis=0) == 0).all(axis=1))
    one, other = half.outward[which[pair]], half.outward[which[pair + 1]]
    sine = np.linalg.norm(one - other, axis=1), np.linalg.norm(one + other, axis=1)
    angle = 180.0 - np.degrees(2 * np.arctan2(*sine))
    np.minimum.at(found, rows[pair, 0], angle)
    return found


def along_and_across(normal: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return tensors [n, d, d] with one value along the normal and one across it, values [n, 2]."""
    along = np.einsum("qi,qj->qij", normal, normal)
    across = np.eye(normal.shape[1]) - along
    return values[:, 0, None, None] * along + values[:, 1, None, None] * across
