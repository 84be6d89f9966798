"""Convex blocks of a file: the hulls of their corners, and what is between two of them."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import shapely
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError

from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.measure import frames, without_straight
from jointwave.cases.geometry.pieces import clipped
from jointwave.cases.geometry.relations import sums
from jointwave.cases.gmsh_file import MeshError

GRAZING = 1e-12  # sine of the angle between planes below which they are parallel
AGAINST = -0.999  # cosine of the angle between normals of faces that may lie against each other
CHUNK = 10_000_000  # heights of corners above faces that are compared at a time


def near(x: np.ndarray) -> str:
    """Return the place of some points in words."""
    return " near [{}]".format(", ".join(f"{place:.6g}" for place in x.mean(axis=0)))


class Solid(NamedTuple):
    """A convex block: its corners [n, d], m; the corners [k, d] of each face, around its normal out
    of the block, in the plane from one end to the other; these normals [f, d], and their distances
    from the origin [f], m."""

    corners: np.ndarray
    faces: list[np.ndarray]
    normals: np.ndarray
    places: np.ndarray

    def heights(self, x: np.ndarray) -> np.ndarray:
        """Return the heights of points [n, d] above the faces [n, f], m."""
        return x @ self.normals.T - self.places

    def split(
        self, x: np.ndarray, face: int, tolerance: float
    ) -> tuple[np.ndarray | None, list[np.ndarray]]:
        """Return the part of a convex piece, by its corners, that lies on a face of the block, in
        whose plane it is, and convex pieces of the rest; None and the piece where there is none."""
        sine = np.linalg.norm(
            self.normals - np.outer(self.normals @ self.normals[face], self.normals[face]), axis=1
        )
        heights = self.heights(x) / np.maximum(sine, GRAZING)
        heights[:, face] = -np.inf
        if (heights.min(axis=0) >= -tolerance).any():
            return None, [x]
        inside, rest = x, []
        for k in np.flatnonzero(heights.max(axis=0) > tolerance):
            away = self.heights(inside)[:, k] / sine[k]
            if away.max() <= tolerance:
                continue
            if away.min() >= -tolerance:
                return None, [x]
            away[np.abs(away) <= tolerance] = 0.0  # on the line
            rest.append(clipped(inside, away))
            inside = clipped(inside, -away)
        return (inside, rest) if width_of(inside) > tolerance else (None, [x])


def width_of(x: np.ndarray) -> float:
    """Return the length of a piece in the plane, in space its area over its length, m."""
    length = float(np.linalg.norm(np.ptp(x, axis=0)))
    if x.shape[1] == 2:
        return length
    away = x[1:] - x[0]
    return float(np.linalg.norm(np.cross(away[:-1], away[1:]).sum(axis=0))) / 2 / length


class Piece(NamedTuple):
    """A convex piece of a face, by its corners [k, d], m: the face, numbered over all blocks, of
    the block that its normal points out of; and that of the block beyond, or OUTSIDE."""

    corners: np.ndarray
    face: int
    beyond: int


def solids_of(x: np.ndarray, blocks: list, names: list[str], tolerance: float) -> list[Solid]:
    """Return the hulls of blocks by their parts, which these must fill; x : float array [v, d], m.
    Raises MeshError for a block whose parts do not, within the tolerance (m)."""
    points = [x[np.unique([v for part in one for loop in part for v in loop])] for one in blocks]
    size, more = _volumes(x, blocks, names, tolerance), ""
    if x.shape[1] == 2:
        rings = shapely.convex_hull([shapely.MultiPoint(one) for one in points])
        volume, surface = shapely.area(rings), shapely.length(rings)
    else:
        hulls, more = [_hull(one) for one in points], ", or open, or has a face turned inwards"
        volume, surface = np.array([(one.volume, one.area) if one else (0, 1) for one in hulls]).T
    least = tolerance * surface
    for wrong, cause in (
        (volume <= least, "flat"),
        (np.abs(volume - size) > least, f"not convex{more}"),
    ):
        if wrong.any():
            k = int(wrong.argmax())
            raise MeshError(f"{names[k]} is {cause}{near(points[k])}")
    if x.shape[1] == 2:
        return [_polygon(one, ring, tolerance) for one, ring in zip(points, rings, strict=True)]
    return [_polyhedron(one, hull, tolerance) for one, hull in zip(points, hulls, strict=True)]


def _hull(x: np.ndarray) -> ConvexHull | None:
    """Return the hull of points in space; None of those in a plane."""
    try:
        return ConvexHull(x)
    except (QhullError, ValueError):
        return None


def _polygon(x: np.ndarray, hull: shapely.Polygon, tolerance: float) -> Solid:
    """Return a block in the plane, whose faces are the edges of its hull."""
    ring = without_straight(*_ring(hull), tolerance).corners
    ends = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    out = (ends[:, 1] - ends[:, 0])[:, ::-1] * [1.0, -1.0]
    normals = out / np.hypot(*out.T)[:, None]
    return Solid(x, list(ends), normals, (normals * ring).sum(axis=1))


def _polyhedron(x: np.ndarray, hull: ConvexHull, tolerance: float) -> Solid:
    """Return a block in space; triangles of its hull that lie in the plane of a larger one are a
    part of that face."""
    edges = np.diff(x[hull.simplices], axis=1).swapaxes(0, 1)
    left, faces, planes = np.linalg.norm(np.cross(*edges), axis=1), [], []
    while left.any():
        plane = hull.equations[left.argmax()]
        on = np.abs(x @ plane[:3] + plane[3]) <= tolerance
        left[on[hull.simplices].all(axis=1)] = 0.0
        axes = np.concatenate(frames(plane[None, :3]))
        ring = _ring(shapely.convex_hull(shapely.MultiPoint(x[on] @ axes.T)))[0]
        faces.append(ring @ axes - plane[3] * plane[:3])
        planes.append(plane)
    return Solid(x, faces, np.array(planes)[:, :3], -np.array(planes)[:, 3])


def _ring(polygon: shapely.Polygon) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a polygon [n, 2], counter-clockwise, and their range."""
    around = shapely.get_exterior_ring(polygon)
    x = shapely.get_coordinates(around)[:-1]
    return x if shapely.is_ccw(around) else x[::-1], np.array([0, len(x)])


def _volumes(x: np.ndarray, blocks: list, names: list[str], tolerance: float) -> np.ndarray:
    """Return the volumes that the faces of blocks enclose, in the plane the areas [n]; raises
    MeshError for a face that is not plane."""
    parts = [part for block in blocks for part in block]
    block = np.repeat(np.arange(len(blocks)), list(map(len, blocks)))
    part = np.repeat(np.arange(len(parts)), list(map(len, parts)))
    loops = [loop for one in parts for loop in one]
    size = np.array(list(map(len, loops)))
    first, loop = np.cumsum(size) - size, np.repeat(np.arange(len(size)), size)
    corners = np.pad(x, ((0, 0), (0, 3 - x.shape[1])))[np.concatenate(loops)]
    away, after = corners - corners[first][loop], np.arange(1, len(corners) + 1)
    after[first + size - 1] = first
    area = np.add.reduceat(np.cross(away, away[after]), first) / 2
    off = np.abs((away * area[loop]).sum(axis=1)) > tolerance * np.linalg.norm(area, axis=1)[loop]
    if off.any():
        k = loop[off.argmax()]
        raise MeshError(f"{names[block[part[k]]]} has a face that is not plane{near(x[loops[k]])}")
    if x.shape[1] == 2:
        return np.bincount(block, weights=np.abs(area[:, 2]))
    centre = sums(part[loop], corners, len(parts)) / np.bincount(part[loop])[:, None]
    cones = (area * (corners[first] - centre[part])).sum(axis=1) / 3
    return np.bincount(block, weights=np.abs(np.bincount(part, weights=cones)))


def pieces_between(solids: list[Solid], names: list[str], tolerance: float) -> list[Piece]:
    """Return the faces of blocks in convex pieces: what two share, once, and what is left of each.
    Raises MeshError for blocks that overlap."""
    first = np.cumsum([0, *(len(one.faces) for one in solids)])
    found, left = list[Piece](), [[face] for one in solids for face in one.faces]
    for i, j, k, m in _touching(solids, names, tolerance):
        one, other = solids[i], solids[j]
        common, _ = other.split(one.faces[k], m, tolerance)
        if common is None or np.abs(other.heights(common)[:, m]).max() > 2 * tolerance:
            continue
        found.append(Piece(common, first[i] + k, first[j] + m))
        for face, by, against in ((first[i] + k, other, m), (first[j] + m, one, k)):
            left[face] = [x for piece in left[face] for x in by.split(piece, against, tolerance)[1]]
    return [*found, *(Piece(x, face, OUTSIDE) for face, own in enumerate(left) for x in own)]


def _touching(
    solids: list[Solid], names: list[str], tolerance: float
) -> Iterator[tuple[int, int, int, int]]:
    """Yield pairs of blocks i < j and their faces that lie against each other, at most one of a
    pair. Raises MeshError where no plane lies between two."""
    corners = _filled([one.corners for one in solids])
    normals = _filled([one.normals for one in solids])
    places = _filled([one.places for one in solids])
    low, high = corners.min(axis=1), corners.max(axis=1)
    tree = shapely.STRtree(shapely.box(*(low[:, :2] - tolerance).T, *(high[:, :2] + tolerance).T))
    pairs = tree.query(tree.geometries)
    meets = np.minimum(*high[pairs]) - np.maximum(*low[pairs])
    close = (meets >= -tolerance).all(axis=1) & ((meets <= tolerance).sum(axis=1) < 2)
    pairs = pairs[:, close & (pairs[0] < pairs[1])]
    for i, j in np.array_split(
        pairs, 1 + pairs.shape[1] * normals[0].size * corners.shape[1] // CHUNK, axis=1
    ):
        heights = [
            (normals[one] @ corners[other].swapaxes(1, 2)).min(axis=2) - places[one]
            for one, other in ((i, j), (j, i))
        ]
        apart = np.max([(height >= -tolerance).any(axis=1) for height in heights], axis=0)
        for k in np.flatnonzero(~apart):
            _check_apart(solids, names, int(i[k]), int(j[k]), tolerance)
        height, other = (np.where(one <= tolerance, one, -np.inf) for one in heights)
        score = height[:, :, None] + other[:, None]
        score[normals[i] @ normals[j].swapaxes(1, 2) > AGAINST] = -np.inf
        best = score.reshape(len(i), normals.shape[1] ** 2).argmax(axis=1)
        k, m = np.divmod(best, normals.shape[1])
        for row in np.flatnonzero(np.isfinite(score[np.arange(len(i)), k, m])):
            yield int(i[row]), int(j[row]), int(k[row]), int(m[row])


def _filled(arrays: list[np.ndarray]) -> np.ndarray:
    """Return arrays as one, those that are shorter with their rows again."""
    most = max(map(len, arrays))
    return np.stack([np.resize(one, (most, *one.shape[1:])) for one in arrays])


def _check_apart(solids: list[Solid], names: list[str], i: int, j: int, tolerance: float) -> None:
    """Raise MeshError where a ball fits into two blocks."""
    one, other = solids[i], solids[j]
    normals, places = (np.concatenate([one[k], other[k]]) for k in (2, 3))
    low, size = one.corners.min(axis=0), float(np.ptp(one.corners, axis=0).max())
    planes = np.column_stack([np.ones(len(normals)), normals])
    heights = (places - normals @ low) / size  # the solver's accuracy is absolute
    ball = size * linprog([-1.0, *(0.0 * low)], planes, heights, bounds=(None, None)).x
    if ball[0] > tolerance:
        raise MeshError(f"{names[i]} and {names[j]} overlap{near(low[None] + ball[1:])}")
