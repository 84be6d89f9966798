"""Bodies as the faces of their cells: moved, coloured, and projected onto a picture; of maps and
films alike."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from jointwave.compare.figures.animation import snapshots
from jointwave.compare.figures.style import FIELD, UNSIGNED
from jointwave.results.snapshots import Snapshots
from jointwave.results.stress import tensors

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
ABOVE = (0.4, 0.3)  # the same of a rock mass in space
EDGE, WIDTH = "#333333", 0.4  # of the faces' edges, points
MANY = 1000  # faces whose edges are thinner, in order not to hide the colours
CELLS = 4000  # faces above which they have no edges
LOUDEST = 99.8  # percentile that the last colour shows ...
SPIKE = 1.25  # ... where the largest value exceeds it by this factor


class Body(NamedTuple):
    """The outside of a body in the axes of a picture: to the right, away from the viewer, up.

    rest : float array [nodes, 3], m, thickness as drawn. motion : float array [snapshots, nodes,
    3], m, as drawn. faces : int array [faces, corners], nodes. values : float array [snapshots,
    faces], shown by the colours, in the quantity's unit. block : int array [faces], of each.
    """

    rest: np.ndarray
    motion: np.ndarray
    faces: np.ndarray
    values: np.ndarray
    block: np.ndarray

    def front(self) -> "Body":
        """Return the faces nearest to the viewer alone."""
        along, away, _ = self.rest[self.faces].mean(axis=1).T
        near = away <= away.min() + 1e-6 * np.ptp(along)
        return self._replace(
            faces=self.faces[near], values=self.values[:, near], block=self.block[near]
        )

    def profile(self) -> pd.DataFrame:
        """Return the mean value of the faces nearest to the viewer by instant, in columns by the
        place along the axis."""
        front = self.front()
        along, values = front.rest[front.faces, 0].mean(axis=1), pd.DataFrame(front.values.T)
        return values.groupby(along.round(9)).mean().T


def body_of(s: Snapshots, settings: snapshots.ViewSettings) -> Body:
    """Return the body of snapshots; lines and sheets of a pillar have its thickness."""
    if settings.side:
        s = _solid(s, settings.side)
    axes = np.stack([settings.right, np.cross(settings.up, settings.right), settings.up], axis=1)
    thick = np.array([1.0, settings.stretch, settings.stretch])
    faces, cells = _outside(s)
    quantity, speed = settings.quantity, np.linalg.norm(s.velocity, axis=2)
    if quantity in (snapshots.STRESS, snapshots.PRINCIPAL):
        assert s.stress is not None
        values = s.stress
        if values.ndim > 2:  # the principal stress of larger size
            low, high = np.moveaxis(np.linalg.eigvalsh(tensors(values))[..., [0, -1]], -1, 0)
            values = np.where(-low > high, low, high)
        values = values[:, cells]
    elif quantity == snapshots.VELOCITY:
        values = (s.velocity @ settings.up)[:, faces].mean(axis=2)
    else:
        speed = speed.max(axis=0, keepdims=True) if quantity == snapshots.PEAK else speed
        values = speed[:, faces].mean(axis=2)
    motion = settings.scale * thick * (s.displacement @ axes)
    return Body(thick * (s.points @ axes), motion, faces, quantity.factor * values, s.block[cells])


def _outside(s: Snapshots) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces that one cell has, counter-clockwise from outside, and their cells."""
    rings = np.array(FACES[s.kind])
    faces = s.cells[:, rings].reshape(-1, rings.shape[1])
    cells = np.repeat(np.arange(len(s.cells)), len(rings))
    once = ~pd.DataFrame(np.sort(faces, axis=1)).duplicated(keep=False).to_numpy()
    faces, cells = faces[once], cells[once]
    if len(rings) > 1:
        x = s.points[faces]
        out = x.mean(axis=1) - s.points[s.cells[cells]].mean(axis=1)
        inwards = (_normals(x) * out).sum(axis=1) < 0
        faces[inwards] = faces[inwards, ::-1]
    return faces, cells


def _normals(corners: np.ndarray) -> np.ndarray:
    """Return normals of faces [n, 3] by their corners [n, k, 3]."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _solid(s: Snapshots, side: float) -> Snapshots:
    """Return snapshots with lines along y, and then sheets, thickened to the side of a section."""
    for kind, thick, axis in (("line", "quad", 0), ("quad", "hexahedron", 2)):
        if s.kind == kind:
            half, other = side / 2 * np.eye(3)[axis], s.cells + len(s.points)
            other = other[:, ::-1] if kind == "line" else other
            s = s._replace(
                kind=thick,
                points=np.concatenate([s.points - half, s.points + half]),
                cells=np.concatenate([s.cells, other], axis=1),
                displacement=np.tile(s.displacement, (1, 2, 1)),
                velocity=np.tile(s.velocity, (1, 2, 1)),
            )
    return s


def colours_of(
    every: list[np.ndarray], sign: str, colours: str | None = None, sizes: Sequence[np.ndarray] = ()
) -> tuple[ScalarMappable, float]:
    """Return the colours of some values, symmetric around zero where they have a sign, and the part
    of the values beyond them.

    The last colour is at the largest value, or at a percentile of all if few exceed it by far;
    then the colour bar ends in an arrow. colours : other ones than ours. sizes : of the values of
    each, of whose sum the part is; absent: all alike.
    """
    found = [np.abs(values).ravel() for values in every]
    most = max(float(one.max(initial=0.0)) for one in found)
    peak = max(float(np.percentile(one, LOUDEST)) for one in found if one.size) if most else 1.0
    is_clipped = most > SPIKE * peak > 0
    peak = peak if is_clipped else most or 1.0
    shown = colormaps[colours or (FIELD if sign else UNSIGNED)].copy()
    if is_clipped:
        ends = "both" if sign else "max"
        shown.colorbar_extend = ends  # type: ignore[assignment]  # its stub has bool
    weight = np.concatenate(list(sizes) or [np.ones(len(one)) for one in found])
    beyond = weight @ (np.concatenate(found) > peak * (1 + 1e-9)) / weight.sum()
    return ScalarMappable(Normalize(-peak if sign else 0.0, peak), shown), float(beyond)


class BodyView:
    """A body in axes, m, from the front or by an oblique parallel projection.

    per_away : what is farther by a metre is drawn by these to the right and up, m.
    """

    def __init__(
        self, ax: Axes, body: Body, colours: ScalarMappable, per_away: tuple[float, float] = FRONT
    ) -> None:
        self.body, (right, up) = body, per_away
        self.projection = np.array([[1.0, 0.0], [right, up], [0.0, 1.0]])
        self.farther = np.array([-right, 1.0, -up])  # along the line of sight
        drawn = (body.rest + body.motion) @ self.projection
        self.low, self.high = drawn.min(axis=(0, 1)), drawn.max(axis=(0, 1))
        # Triangles, and many quadrilaterals, are parts of blocks.
        edges = EDGE if body.faces.shape[1] > 3 and len(body.faces) <= CELLS else "face"
        width = WIDTH * min(1.0, MANY / len(body.faces))
        # Edges that blend into the background would leave seams between faces of one colour.
        self.faces = PolyCollection(
            [], edgecolors=edges, linewidths=width, antialiaseds=edges == EDGE
        )
        self.faces.set(cmap=colours.get_cmap(), norm=colours.norm, clip_on=False)
        ax.add_collection(self.faces, autolim=False)
        margin = 0.02 * (self.high - self.low).min()
        ax.set(xlim=(self.low[0] - margin, self.high[0] + margin), aspect="equal")
        ax.set_ylim(self.low[1] - margin, self.high[1] + margin)

    def show(self, i: int) -> None:
        """Update the picture to an instant; the nearest faces of the nearest block are drawn last.
        Of a body seen obliquely those that face away are left out: they would cover others that
        touch them."""
        corners, block = (self.body.rest + self.body.motion[i])[self.body.faces], self.body.block
        away = corners.mean(axis=1) @ self.farther
        count = np.maximum(np.bincount(block), 1)
        of_block = (np.bincount(block, away) / count)[block]
        order = np.lexsort((-away, -of_block))
        if self.farther[0]:
            order = order[_normals(corners[order]) @ self.farther <= 0]
        self.faces.set_verts(corners[order] @ self.projection)
        self.faces.set_array(self.body.values[i, order])
