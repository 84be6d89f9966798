"""Bodies as faces of cells, displaced, coloured and projected, for maps and films."""

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
FRONT, OBLIQUE = (0.0, 0.0), (0.1, 0.4)  # shift to the right and up per metre of depth
ABOVE = (0.4, 0.3)  # shift per metre of depth of a rock mass in space
EDGE, WIDTH = "#333333", 0.4  # of the faces' edges, points
MANY = 1000  # faces above which edges are thinner, not to hide the colours
CELLS = 4000  # faces above which edges are not drawn
LOUDEST = 99.8  # percentile at the last colour ...
SPIKE = 1.25  # ... if the largest value exceeds it by this factor


class Body(NamedTuple):
    """The surface of a body in the axes of a picture (right, away from the viewer, up).

    rest : undeformed positions [nodes, 3], m, thickness as drawn. motion : drawn displacements
    [snapshots, nodes, 3], m. faces : node indices [faces, corners]. values : of the colours
    [snapshots, faces], in the quantity's unit. block : of each face [faces].
    """

    rest: np.ndarray
    motion: np.ndarray
    faces: np.ndarray
    values: np.ndarray
    block: np.ndarray

    def front(self) -> "Body":
        """Return only the faces nearest to the viewer."""
        along, away, _ = self.rest[self.faces].mean(axis=1).T
        near = away <= away.min() + 1e-6 * np.ptp(along)
        return self._replace(
            faces=self.faces[near], values=self.values[:, near], block=self.block[near]
        )

    def profile(self) -> pd.DataFrame:
        """Return the mean values of front faces, a row per instant, a column per axial position."""
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
        if values.ndim > 2:  # principal stress of larger magnitude
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
    """Return the outer faces, counter-clockwise from outside, and the indices of their cells."""
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
    """Return normals [n, 3] of faces from their corners [n, k, 3]."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _solid(s: Snapshots, side: float) -> Snapshots:
    """Return snapshots with lines, or sheets, thickened to a square section of this side, m."""
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
    """Return the colour scale of values, symmetric if signed, and the fraction of values beyond it.

    The scale ends at the largest value, or at a percentile if few values far exceed it; the colour
    bar then ends in an arrow. colours : name of a colour map; None: the default. sizes : weights of
    the values in the fraction; empty: equal.
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


def _places(body: Body, farther: np.ndarray) -> np.ndarray:
    """Return how many convex blocks are drawn before that of each face [faces]: those that the
    plane of a face parts from the viewer, on whose near side it lies, and those behind them."""
    block, x = np.unique(body.block, return_inverse=True)[1], body.rest[body.faces]
    x, normal = x / np.ptp(x), _normals(x) / np.linalg.norm(_normals(x), axis=1)[:, None]
    planes = np.column_stack([normal, (normal * x[:, 0]).sum(axis=1)]).round(6)
    never = np.zeros((block.max() + 1,) * 2, dtype=bool)  # does the second hide the first
    for k in range(len(never)):
        n, at = np.split(np.unique(planes[block == k], axis=0), [3], axis=1)
        beyond = pd.DataFrame((x @ n.T > at.T - 1e-5).all(axis=1)).groupby(block).all().to_numpy()
        never[k] |= beyond[:, n @ farther > 0].any(axis=1)
        never[:, k] |= beyond[:, n @ farther < 0].any(axis=1)
    behind = never & ~never.T  # the first, the second
    for _ in range(len(behind).bit_length()):
        behind |= behind @ behind
    return behind.sum(axis=1)[block]


class BodyView:
    """A body in axes, m, seen from the front or in an oblique parallel projection.

    per_away : shift to the right and up per metre of depth, m.
    """

    def __init__(
        self, ax: Axes, body: Body, colours: ScalarMappable, per_away: tuple[float, float] = FRONT
    ) -> None:
        self.body, (right, up) = body, per_away
        self.projection = np.array([[1.0, 0.0], [right, up], [0.0, 1.0]])
        self.farther = np.array([-right, 1.0, -up])  # along the line of sight
        parted = per_away == ABOVE and body.block.max() < 500  # of more, by mean distances
        self.place = _places(body, self.farther) if parted else None
        drawn = (body.rest + body.motion) @ self.projection
        self.low, self.high = drawn.min(axis=(0, 1)), drawn.max(axis=(0, 1))
        # Triangles, and quadrilaterals if many, are only parts of blocks.
        edges = EDGE if body.faces.shape[1] > 3 and len(body.faces) <= CELLS else "face"
        width = WIDTH * min(1.0, MANY / len(body.faces))
        # Antialiased edges would leave seams between faces of one colour.
        self.faces = PolyCollection(
            [], edgecolors=edges, linewidths=width, antialiaseds=edges == EDGE
        )
        self.faces.set(cmap=colours.get_cmap(), norm=colours.norm, clip_on=False)
        ax.add_collection(self.faces, autolim=False)
        margin = 0.02 * (self.high - self.low).min()
        ax.set(xlim=(self.low[0] - margin, self.high[0] + margin), aspect="equal")
        ax.set_ylim(self.low[1] - margin, self.high[1] + margin)

    def show(self, i: int) -> None:
        """Update the picture to an instant, drawing the nearest faces of the nearest block last. In
        an oblique view faces turned away are left out, as they would cover adjacent faces."""
        corners, block = (self.body.rest + self.body.motion[i])[self.body.faces], self.body.block
        away = corners.mean(axis=1) @ self.farther
        mean = pd.Series(away).groupby(block).transform("mean")
        order = np.lexsort((-away, -mean if self.place is None else self.place))
        if self.farther[0]:
            order = order[_normals(corners[order]) @ self.farther <= 0]
        self.faces.set_verts(corners[order] @ self.projection)
        self.faces.set_array(self.body.values[i, order])
