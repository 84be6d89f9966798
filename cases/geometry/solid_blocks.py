"""Convex blocks of a file as hulls of their corners, and the pieces between neighbours."""

from typing import NamedTuple

import numpy as np
import shapely
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError

from jointwave.cases.errors import placed
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.measure import frames
from jointwave.cases.geometry.pieces import clipped
from jointwave.cases.geometry.relations import sums
from jointwave.cases.geometry.solids import corners_of
from jointwave.cases.gmsh_file import MeshError

GRAZING = 1e-12  # sine of the angle between planes below which they are parallel
AGAINST = -0.999  # cosine between the normals of faces that may touch


def near(x: np.ndarray) -> str:
    """Return the mean place of some points as text."""
    return f" near {placed(x.mean(axis=0))}"


Piece = tuple[np.ndarray, int, int]


class Solid(NamedTuple):
    """A convex block: corners [n, d], m; corners [k, d] of each face, around its outward normal (in
    the plane the two ends); normals [f, d]; and distances of the faces from the origin [f], m."""

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
        """Split a convex piece (corners in a face's plane) into its overlap with the face and
        convex pieces of the rest; return None and the piece itself without overlap."""
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
            away[np.abs(away) <= tolerance] = 0.0  # points on the line
            rest.append(clipped(inside, away))
            inside = clipped(inside, -away)
        return (inside, rest) if width_of(inside) > tolerance else (None, [x])


def width_of(x: np.ndarray) -> float:
    """Return a piece's length in the plane, or its area over its length in space, m."""
    length = float(np.linalg.norm(np.ptp(x, axis=0)))
    if x.shape[1] == 2:
        return length
    away = x[1:] - x[0]
    return float(np.linalg.norm(np.cross(away[:-1], away[1:]).sum(axis=0))) / 2 / length


def solids_of(x: np.ndarray, blocks: list, names: list[str], tolerance: float) -> list[Solid]:
    """Return the hulls of blocks; x : float array [v, d], m, their vertices. Raises MeshError for a
    block that is flat or does not fill its hull within the tolerance (m)."""
    more = ", or open, or has a face turned inwards" if x.shape[1] == 3 else ""
    found, sizes = list[Solid](), _volumes(x, blocks, names, tolerance)
    for block, size, name in zip(blocks, sizes, names, strict=True):
        points = x[np.unique([v for part in block for loop in part for v in loop])]
        try:
            hull = ConvexHull(points)
        except (QhullError, ValueError):  # the points lie in a plane
            hull = None
        if hull is None or hull.volume <= tolerance * hull.area:
            raise MeshError(f"{name} is flat{near(points)}")
        if abs(hull.volume - size) > tolerance * hull.area:
            raise MeshError(f"{name} is not convex{more}{near(points)}")
        found.append(_solid(points, hull, tolerance))
    return found


def _solid(x: np.ndarray, hull: ConvexHull, tolerance: float) -> Solid:
    """Return a block from its hull; coplanar simplices make one face."""
    edges = np.diff(x[hull.simplices], axis=1).swapaxes(0, 1)
    size = edges[0] if x.shape[1] == 2 else np.cross(*edges)
    left, faces, normals, places = np.linalg.norm(size, axis=1), [], [], []
    while left.any():
        *normal, below = hull.equations[left.argmax()]
        n, on = np.array(normal), np.abs(x @ normal + below) <= tolerance
        left[on[hull.simplices].all(axis=1)] = 0.0
        if len(n) == 2:
            axes = np.array([[-n[1], n[0]]])
            along = x[on] @ axes.T
            ring = np.stack([along.min(axis=0), along.max(axis=0)])
        else:
            axes = np.concatenate(frames(n[None]))
            ring = corners_of(shapely.convex_hull(shapely.MultiPoint(x[on] @ axes.T)))
        faces.append(ring @ axes - below * n)
        normals.append(n)
        places.append(-below)
    return Solid(x, faces, np.array(normals), np.array(places))


def _volumes(x: np.ndarray, blocks: list, names: list[str], tolerance: float) -> np.ndarray:
    """Return the volumes (in the plane: areas) [n] that the faces of blocks enclose. Raises
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
    """Return the faces of blocks in convex pieces: what two blocks share, once, and the rest of
    each. A piece has its corners [k, d], m; its face, numbered over all blocks; and the face on the
    other side, or OUTSIDE. Raises MeshError for blocks that overlap."""
    first = np.cumsum([0, *(len(one.faces) for one in solids)])
    found, left = list[Piece](), [[face] for one in solids for face in one.faces]
    for i, j in _close(solids, tolerance):
        one, other = solids[i], solids[j]
        above, beyond = (a.heights(b.corners).min(axis=0) for a, b in ((one, other), (other, one)))
        if max(above.max(), beyond.max()) < -tolerance:
            _check_overlap(one, other, f"{names[i]} and {names[j]}", tolerance)
        above, beyond = (np.where(h <= tolerance, h, -np.inf) for h in (above, beyond))
        score = above[:, None] + beyond
        score[one.normals @ other.normals.T > AGAINST] = -np.inf
        k, m = divmod(int(score.argmax()), len(beyond))
        if not np.isfinite(score[k, m]):
            continue
        face, beyond, alike = one.faces[k], other.faces[m], False
        if len(face) == len(beyond):
            alike = np.abs(face[:, None] - beyond).max(axis=2).min(axis=1).max() <= tolerance
        common = face if alike else other.split(face, m, tolerance)[0]
        if common is None or np.abs(other.heights(common)[:, m]).max() > 2 * tolerance:
            continue
        found.append((common, first[i] + k, first[j] + m))
        for n, by, against in ((first[i] + k, other, m), (first[j] + m, one, k)):
            rest = [] if alike else left[n]
            left[n] = [x for piece in rest for x in by.split(piece, against, tolerance)[1]]
    return [*found, *((x, face, OUTSIDE) for face, own in enumerate(left) for x in own)]


def _close(solids: list[Solid], tolerance: float) -> list[list[int]]:
    """Return pairs of blocks i < j whose bounding boxes touch in at least a face."""
    low, high = (np.array([at(one.corners, axis=0) for one in solids]) for at in (np.min, np.max))
    tree = shapely.STRtree(shapely.box(*(low[:, :2] - tolerance).T, *(high[:, :2] + tolerance).T))
    pairs = tree.query(tree.geometries)
    meets = np.minimum(*high[pairs]) - np.maximum(*low[pairs])
    close = (meets >= -tolerance).all(axis=1) & ((meets <= tolerance).sum(axis=1) < 2)
    return pairs[:, close & (pairs[0] < pairs[1])].T.tolist()


def _check_overlap(one: Solid, other: Solid, names: str, tolerance: float) -> None:
    """Raise MeshError if a ball larger than the tolerance fits into both blocks."""
    normals, places = (np.concatenate([one[k], other[k]]) for k in (2, 3))
    low, size = one.corners.min(axis=0), float(np.ptp(one.corners, axis=0).max())
    planes = np.column_stack([np.ones(len(normals)), normals])
    heights = (places - normals @ low) / size  # the solver's accuracy is absolute
    ball = size * linprog([-1.0, *(0.0 * low)], planes, heights, bounds=(None, None)).x
    if ball[0] > tolerance:
        raise MeshError(f"{names} overlap{near(low[None] + ball[1:])}")
