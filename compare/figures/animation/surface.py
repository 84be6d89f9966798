"""The visible surface of a pillar's cells, and an engine's wave on it at each instant."""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from compare.figures.animation.view_settings import STRESS, ViewSettings
from results.snapshots import Snapshots

#: Corners of the faces of a cell, anticlockwise from outside.
FACES = {
    "line": [[0, 1]],
    "triangle": [[0, 1, 2]],
    "quad": [[0, 1, 2, 3]],
    "tetra": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    "hexahedron": [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ],
}
SHARP = 0.9  # cosine of the angle between two faces: below it their edge is drawn
Y = np.array([0.0, 1.0, 0.0])


class Surface(NamedTuple):
    """The outside of all blocks.

    faces : int array [faces, corners], nodes, anticlockwise from outside. cells : int array
    [faces], the cell behind each. edges : int array [edges, 2], nodes of a block's edges.
    beside : int array [edges, 2], the faces on both sides of an edge, twice the same at a rim.
    flat : whether the cells are faces themselves, visible from both sides.
    """

    faces: np.ndarray
    cells: np.ndarray
    edges: np.ndarray
    beside: np.ndarray
    flat: bool


def solid(s: Snapshots, side: float) -> Snapshots:
    """Return snapshots with lines along y and flat quadrilaterals thickened to hexahedra.

    side : of the section, m. Cells with their full width are returned unchanged.
    """
    if s.kind == "line":
        s = _thick(s, 0, side, "quad")
    return _thick(s, 2, side, "hexahedron") if s.kind == "quad" else s


def _thick(s: Snapshots, axis: int, side: float, kind: str) -> Snapshots:
    """Return cells thickened by half a side in both directions of an axis, with uniform motion."""
    half, nodes = np.zeros(3), len(s.points)
    half[axis] = side / 2
    cells = s.cells, s.cells + nodes
    if kind == "quad":  # its corners are anticlockwise as seen from z
        cells = cells[1], cells[0][:, ::-1]
    return s._replace(
        kind=kind,
        points=np.concatenate([s.points - half, s.points + half]),
        cells=np.concatenate(cells, axis=1),
        displacement=np.concatenate([s.displacement, s.displacement], axis=1),
        velocity=np.concatenate([s.velocity, s.velocity], axis=1),
    )


def surface_of(s: Snapshots) -> Surface:
    """Return the outside of the blocks of snapshots, for any kind of cells."""
    rings = np.array(FACES[s.kind])
    faces = s.cells[:, rings].reshape(-1, rings.shape[1])
    cells = np.repeat(np.arange(len(s.cells)), len(rings))
    _, which, times = np.unique(
        np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    outside = times[which.ravel()] == 1
    faces, cells = faces[outside], cells[outside]
    a, b, d = (s.points[faces[:, k]] for k in (0, 1, -1))
    normals = np.cross(b - a, d - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    outwards = s.points[faces].mean(axis=1) - s.points[s.cells].mean(axis=1)[cells]
    inside_out = (normals * outwards).sum(axis=1) < 0
    faces[inside_out], normals[inside_out] = faces[inside_out, ::-1], -normals[inside_out]
    return Surface(faces, cells, *_edges(faces, normals), flat=len(rings) == 1)


def _edges(faces: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges at which faces end or bend, and the faces beside them."""
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), faces.shape[1])
    edges, which = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    which = which.ravel()
    beside = np.empty((len(edges), 2), dtype=int)
    beside[which, 0] = owner  # of two faces the last one written
    beside[which[::-1], 1] = owner[::-1]
    cosine = (normals[beside[:, 0]] * normals[beside[:, 1]]).sum(axis=1)
    drawn = (cosine < SHARP) | (beside[:, 0] == beside[:, 1])
    return edges[drawn], beside[drawn]


def seen(points: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return points [..., 3] (m) as seen with y to the right and the unit vector `up` upwards:
    to the right, up, and towards the viewer."""
    return points @ np.stack([Y, up, np.cross(Y, up)], axis=-1)


def in_front(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Return the faces that face the viewer, the farthest first; points [nodes, 3] in the axes of
    `seen`."""
    corners = points[surface.faces]
    x, y, depth = np.moveaxis(corners, 2, 0)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    area = np.abs(area) if surface.flat else area
    front = np.flatnonzero(area > 1e-6 * np.abs(area).max())
    return front[np.argsort(depth[front].mean(axis=1), kind="stable")]


class Wave:
    """One engine's pillar under the settings of a view.

    values : float array [snapshots, faces], quantity shown by the colours, SI.
    """

    def __init__(self, s: Snapshots, settings: ViewSettings, side: float) -> None:
        self.s, self.settings = solid(s, side), settings
        self.surface = surface_of(self.s)
        self.values = self._values()

    def points(self, i: int) -> np.ndarray:
        """Return the drawn positions of the nodes at instant i [nodes, 3], m: to the right, up
        (before the stretch), towards the viewer."""
        return seen(self.s.points + self.settings.scale * self.s.displacement[i], self.settings.up)

    def drawn(self, i: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the polygons [n, corners, 2] of instant i, the farthest first, the face of each
        [n], and the edges [m, 2, 2] between faces, m."""
        points, surface = self.points(i), self.surface
        front = in_front(surface, points)
        is_front = np.zeros(len(surface.faces), dtype=bool)
        is_front[front] = True
        edges = surface.edges[is_front[surface.beside].any(axis=1)]
        return points[surface.faces[front], :2], front, points[edges, :2]

    def _values(self) -> np.ndarray:
        s, surface = self.s, self.surface
        if self.settings.quantity == STRESS:
            assert s.stress is not None
            return s.stress[:, surface.cells]
        return (s.velocity @ self.settings.up)[:, surface.faces].mean(axis=2)

    @cached_property
    def _sections(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the faces visible at rest, their sections, and the sections' y [n], m."""
        front = in_front(self.surface, seen(self.s.points, self.settings.up))
        at = self.s.points[self.surface.faces[front], 1].mean(axis=1)
        y, which = np.unique(at.round(9), return_inverse=True)
        return front, which.ravel(), y

    @property
    def y(self) -> np.ndarray:
        """The sections of `profile` [n], m, in the unloaded pillar."""
        return self._sections[2]

    @cached_property
    def profile(self) -> np.ndarray:
        """Quantity shown by the colours along y [snapshots, n], the mean over each section, SI."""
        front, which, y = self._sections
        count = np.bincount(which)
        rows = [np.bincount(which, row[front], minlength=y.size) / count for row in self.values]
        return np.array(rows)

    def reach(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest and the largest drawn coordinates to the right and upwards, m."""
        drawn = [self.points(i)[:, :2] for i in range(len(self.s.time))]
        low = np.min([x.min(axis=0) for x in drawn], axis=0)
        return low, np.max([x.max(axis=0) for x in drawn], axis=0)
