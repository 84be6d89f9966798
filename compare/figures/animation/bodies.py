"""Bodies drawn by matplotlib into axes: from the front, or in space."""

from math import atan2, degrees, hypot

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D, proj3d
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from jointwave.compare.figures.animation.polygons import Polygons

EDGE, WIDTH = "#333333", 0.4  # of the polygons' edges, points
DENSE = 2.5  # points: closer edges would hide the colours
TOWARDS = 0.05, -1.0, 0.35  # to the viewer of bodies in space, in the axes of `Polygons`
MARGIN = 1.04  # of the size of a body, of a picture of it

Box = tuple[float, float, float, float]  # left, bottom, width and height, of a figure


class FrontView:
    """A body in the plane: the faces nearest to the viewer, in axes with metres."""

    def __init__(self, figure: Figure, box: Box, body: Polygons, colours: ScalarMappable) -> None:
        self.body, self.colours = body.front(), colours
        self.ax = ax = figure.add_axes(box)
        low, high = body.reach()[:, [0, 2]]
        margin = (MARGIN - 1) * (high - low).min()
        ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
        points = 72 * box[2] * figure.get_figwidth()
        spacing = points * np.ptp(self.body.at(0)[..., 0], axis=1).max() / (high - low)[0]
        shown = spacing > DENSE and self.body.faces.shape[1] > 3  # triangles are parts of blocks
        edges = EDGE if shown else "face"
        self.faces = PolyCollection([], edgecolors=edges, linewidths=WIDTH)
        ax.add_collection(self.faces, autolim=False)

    def show(self, i: int) -> None:
        """Update the picture to an instant."""
        self.faces.set_verts(list(self.body.at(i)[..., [0, 2]]))
        self.faces.set(facecolor=self.colours.to_rgba(self.body.values[i]))


class SpaceView:
    """A body in space, by matplotlib: in orthogonal projection, filling a box of a figure."""

    def __init__(
        self,
        figure: Figure,
        box: Box,
        body: Polygons,
        colours: ScalarMappable,
        towards: tuple[float, float, float] = TOWARDS,
    ) -> None:
        self.body, self.colours = body, colours
        low, high = body.reach()
        right, away, up = towards
        square = _square(figure, box)
        ax = figure.add_axes(square, projection="3d", proj_type="ortho")
        assert isinstance(ax, Axes3D)
        ax.set_axis_off()
        ax.patch.set_visible(False)
        ax.view_init(degrees(atan2(up, hypot(right, away))), degrees(atan2(away, right)))
        size = np.maximum(high - low, 1e-9 * np.ptp(body.rest))
        ax.set(xlim=(low[0], low[0] + size[0]), ylim=(low[1], low[1] + size[1]))
        ax.set(zlim=(low[2], low[2] + size[2]))
        ax.set_box_aspect(size)
        first, last = _seen(ax, low, high)
        ax.set_box_aspect(size, zoom=float(min(box[2:] / (last - first))) / MARGIN)
        shift = box[:2] + np.array(box[2:]) / 2 - _seen(ax, low, high).mean(axis=0)
        ax.set_position((*(square[:2] + shift), *square[2:]))
        self.ax, self.faces = ax, Poly3DCollection(body.at(0), edgecolors=EDGE, linewidths=WIDTH)
        ax.add_collection3d(self.faces)

    def show(self, i: int) -> None:
        """Update the picture to an instant."""
        self.faces.set_verts(list(self.body.at(i)))
        self.faces.set(facecolor=self.colours.to_rgba(self.body.values[i]))


def _square(figure: Figure, box: Box) -> Box:
    """Return the square around the middle of a box, as wide as the figure: axes in space keep to
    one, whatever is in them."""
    left, bottom, width, height = box
    across, up = figure.get_size_inches()
    tall = across / up
    return left + width / 2 - 0.5, bottom + height / 2 - tall / 2, 1.0, tall


def _seen(ax: Axes3D, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the lower left and the upper right corner of a cuboid in the figure, fractions."""
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    x, y, _ = proj3d.proj_transform(*corners.T, ax.get_proj())
    to_figure = ax.transData - ax.figure.transFigure
    seen = to_figure.transform(np.stack([x, y], axis=1))
    return np.stack([seen.min(axis=0), seen.max(axis=0)])
