"""Bodies as polygons: the visible faces of their cells, moved and coloured at each instant."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.animation.settings import (
    DISPLACEMENT,
    STRESS,
    VELOCITY,
    Quantity,
    ViewSettings,
)
from jointwave.results.snapshots import Snapshots

#: Corners of the faces of a cell.
FACES = {
    "triangle": [[0, 1, 2]],
    "quad": [[0, 1, 2, 3]],
    "tetra": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    "hexahedron": [
        *[[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4]],
        *[[1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    ],
}


class Polygons(NamedTuple):
    """The outside of a body in the axes of a picture: to the right, away from the viewer, up.

    rest : float array [nodes, 3], m, thickness as drawn. motion : float array [snapshots, nodes,
    3], m, as drawn. faces : int array [faces, corners], nodes. values : float array [snapshots,
    faces], shown by the colours, in the quantity's unit.
    """

    rest: np.ndarray
    motion: np.ndarray
    faces: np.ndarray
    values: np.ndarray

    def at(self, i: int) -> np.ndarray:
        """Return the corners of the polygons at an instant [faces, corners, 3], m."""
        return (self.rest + self.motion[i])[self.faces]

    def reach(self) -> np.ndarray:
        """Return the smallest and the largest drawn coordinates [2, 3], m."""
        low, high = self.motion.min(axis=0) + self.rest, self.motion.max(axis=0) + self.rest
        return np.stack([low.min(axis=0), high.max(axis=0)])

    def front(self) -> "Polygons":
        """Return the faces of a prism along the axis that face the viewer at rest, or all faces of
        a body in the plane."""
        corners = self.rest[self.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])
        outwards = corners.mean(axis=1) - (self.rest.min(axis=0) + self.rest.max(axis=0)) / 2
        outwards[:, 0] = 0.0
        towards = -np.sign((normals * outwards).sum(axis=1)) * normals[:, 1]
        shown = towards > 0.01 * np.linalg.norm(normals, axis=1)
        if not np.ptp(self.rest[:, 1]):
            shown[:] = True
        return self._replace(faces=self.faces[shown], values=self.values[:, shown])

    def profile(self) -> pd.DataFrame:
        """Return the mean value of the front by instant, in columns by the place along the axis."""
        front = self.front()
        along = self.rest[front.faces, 0].mean(axis=1).round(9)
        return pd.DataFrame(front.values.T).groupby(along).mean().T


def polygons_of(s: Snapshots, scene: object, settings: ViewSettings) -> Polygons:
    """Return the polygons of snapshots; lines and sheets of a pillar have its thickness."""
    up, right = settings.up, np.array([1.0, 0.0, 0.0])
    if isinstance(scene, Scene):
        s, right = _solid(s, scene.pillar.side), np.array([0.0, 1.0, 0.0])
    axes = np.stack([right, np.cross(up, right), up], axis=1)
    thick = np.array([1.0, settings.stretch, settings.stretch])
    faces, cells = _outside(s)
    return Polygons(
        thick * (s.points @ axes),
        settings.scale * thick * (s.displacement @ axes),
        faces,
        settings.quantity.factor * _values(s, faces, cells, settings.quantity, up),
    )


def _values(
    s: Snapshots, faces: np.ndarray, cells: np.ndarray, quantity: Quantity, up: np.ndarray
) -> np.ndarray:
    """Return a quantity on faces [snapshots, faces], SI: of their cell, or the corners' mean."""
    if quantity == STRESS:
        assert s.stress is not None
        return s.stress[:, cells]
    if quantity == VELOCITY:
        return (s.velocity @ up)[:, faces].mean(axis=2)
    vectors = s.displacement if quantity == DISPLACEMENT else s.velocity
    return np.linalg.norm(vectors, axis=2)[:, faces].mean(axis=2)


def _outside(s: Snapshots) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces that one cell has, and their cells."""
    rings = np.array(FACES[s.kind])
    faces = s.cells[:, rings].reshape(-1, rings.shape[1])
    cells = np.repeat(np.arange(len(s.cells)), len(rings))
    _, which, times = np.unique(
        np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    single = times[which.ravel()] == 1
    return faces[single], cells[single]


def _solid(s: Snapshots, side: float) -> Snapshots:
    """Return snapshots with lines along y, and then sheets, thickened to the side of a section."""
    for kind, thick, axis in (("line", "quad", 0), ("quad", "hexahedron", 2)):
        if s.kind != kind:
            continue
        half, other = np.zeros(3), s.cells + len(s.points)
        half[axis] = side / 2
        ends = (s.cells, other[:, ::-1]) if kind == "line" else (s.cells, other)
        s = s._replace(
            kind=thick,
            points=np.concatenate([s.points - half, s.points + half]),
            cells=np.concatenate(ends, axis=1),
            displacement=np.concatenate([s.displacement, s.displacement], axis=1),
            velocity=np.concatenate([s.velocity, s.velocity], axis=1),
        )
    return s
