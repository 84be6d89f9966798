"""One engine at each instant: polygons, edges, colours, and the wave along y."""

from functools import cached_property

import numpy as np

from compare.figures.animation.surface import in_front, seen, solid, surface_of
from compare.figures.animation.view_settings import STRESS, ViewSettings
from results.snapshots import Snapshots


class Wave:
    """One engine's pillar under the settings of a view.

    values : float array [snapshots, faces], what the colours show, SI.
    """

    def __init__(self, s: Snapshots, settings: ViewSettings, side: float) -> None:
        self.s, self.settings = solid(s, side), settings
        self.surface = surface_of(self.s)
        self.values = self._values()

    def points(self, i: int) -> np.ndarray:
        """Return where the nodes of instant i are drawn [nodes, 3], m: to the right, up (before
        the stretch), towards the viewer."""
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
        """Return the faces seen at rest, the sections that they lie at, and these [n], m."""
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
        """What the colours show along y [snapshots, n], the mean over each section, SI."""
        front, which, y = self._sections
        count = np.bincount(which)
        rows = [np.bincount(which, row[front], minlength=y.size) / count for row in self.values]
        return np.array(rows)

    def reach(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the least and the largest place to the right and upwards that is drawn, m."""
        drawn = [self.points(i)[:, :2] for i in range(len(self.s.time))]
        low = np.min([x.min(axis=0) for x in drawn], axis=0)
        return low, np.max([x.max(axis=0) for x in drawn], axis=0)
