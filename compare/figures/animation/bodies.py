"""Bodies as the faces of their cells: moved, coloured, and projected onto a picture."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.animation.settings import STRESS, VELOCITY, ViewSettings
from jointwave.compare.figures.style import FIELD, UNSIGNED
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
FRONT, OBLIQUE = (0.0, 0.0), (0.1, 0.4)  # to the right and up per metre away from the viewer
EDGE, WIDTH = "#333333", 0.4  # of the faces' edges, points
MANY = 1000  # faces whose edges are thinner, in order not to hide the colours
LOUDEST = 99.8  # percentile of an unsigned quantity shown by the last colour


class Body(NamedTuple):
    """The outside of a body in the axes of a picture: to the right, away from the viewer, up.

    rest : float array [nodes, 3], m, thickness as drawn. motion : float array [snapshots, nodes,
    3], m, as drawn. faces : int array [faces, corners], nodes. values : float array [snapshots,
    faces], shown by the colours, in the quantity's unit.
    """

    rest: np.ndarray
    motion: np.ndarray
    faces: np.ndarray
    values: np.ndarray

    def profile(self) -> pd.DataFrame:
        """Return the mean value of the faces nearest to the viewer by instant, in columns by the
        place along the axis."""
        along, away, _ = self.rest[self.faces].mean(axis=1).T
        near = away <= away.min() + 1e-6 * np.ptp(along)
        values = pd.DataFrame(self.values[:, near].T)
        return values.groupby(along[near].round(9)).mean().T


def body_of(s: Snapshots, scene: object, settings: ViewSettings) -> Body:
    """Return the body of snapshots; lines and sheets of a pillar have its thickness."""
    up, right = settings.up, np.array([1.0, 0.0, 0.0])
    if isinstance(scene, Scene):
        s, right = _solid(s, scene.pillar.side), np.array([0.0, 1.0, 0.0])
    axes = np.stack([right, np.cross(up, right), up], axis=1)
    thick = np.array([1.0, settings.stretch, settings.stretch])
    faces, cells = _outside(s)
    if settings.quantity == STRESS:
        assert s.stress is not None
        values = s.stress[:, cells]
    elif settings.quantity == VELOCITY:
        values = (s.velocity @ up)[:, faces].mean(axis=2)
    else:
        values = np.linalg.norm(s.velocity, axis=2)[:, faces].mean(axis=2)
    motion = settings.scale * thick * (s.displacement @ axes)
    return Body(thick * (s.points @ axes), motion, faces, settings.quantity.factor * values)


def _outside(s: Snapshots) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces that one cell has, and their cells."""
    rings = np.array(FACES[s.kind])
    faces = s.cells[:, rings].reshape(-1, rings.shape[1])
    cells = np.repeat(np.arange(len(s.cells)), len(rings))
    once = ~pd.DataFrame(np.sort(faces, axis=1)).duplicated(keep=False).to_numpy()
    return faces[once], cells[once]


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


def colours_of(bodies: list[Body], settings: ViewSettings) -> ScalarMappable:
    """Return the colours of a quantity, symmetric around zero where it has a sign."""
    every = [np.abs(body.values) for body in bodies]
    if settings.quantity.sign:
        peak = max(float(values.max()) for values in every) or 1.0
        return ScalarMappable(Normalize(-peak, peak), FIELD)
    peak = max(float(np.percentile(values, LOUDEST)) for values in every) or 1.0
    return ScalarMappable(Normalize(0.0, peak), UNSIGNED)


class BodyView:
    """A body in axes, m, from the front or by an oblique parallel projection.

    per_away : what is farther by a metre is drawn by these to the right and up, m.
    """

    def __init__(
        self,
        ax: Axes,
        body: Body,
        colours: ScalarMappable,
        per_away: tuple[float, float] = FRONT,
    ) -> None:
        self.body, (right, up) = body, per_away
        self.projection = np.array([[1.0, 0.0], [right, up], [0.0, 1.0]])
        self.farther = np.array([-right, 1.0, -up])  # along the line of sight
        drawn = (body.rest + body.motion) @ self.projection
        self.low, self.high = drawn.min(axis=(0, 1)), drawn.max(axis=(0, 1))
        edges = EDGE if body.faces.shape[1] > 3 else "face"  # triangles are parts of blocks
        width = WIDTH * min(1.0, MANY / len(body.faces))
        self.faces = PolyCollection([], edgecolors=edges, linewidths=width)
        self.faces.set(cmap=colours.get_cmap(), norm=colours.norm, clip_on=False)
        ax.add_collection(self.faces, autolim=False)
        margin = 0.02 * (self.high - self.low).min()
        ax.set(xlim=(self.low[0] - margin, self.high[0] + margin), aspect="equal")
        ax.set_ylim(self.low[1] - margin, self.high[1] + margin)

    def show(self, i: int) -> None:
        """Update the picture to an instant; the nearest faces are drawn last."""
        corners = (self.body.rest + self.body.motion[i])[self.body.faces]
        order = np.argsort(-(corners.mean(axis=1) @ self.farther), kind="stable")
        self.faces.set_verts(corners[order] @ self.projection)
        self.faces.set_array(self.body.values[i, order])
