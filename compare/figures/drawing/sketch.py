"""A scene as named shapes in metres, and their picture: what pillars and rock masses share."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D

from jointwave.cases.schema.plane import GravityInPlane
from jointwave.cases.schema.tables import Gravity

INK, LOAD, RECEIVER, LAYER = "#1c2126", "#b3001b", "#00549e", "#8a3b12"
ROCK, EDGE, SOFT = "#efe9dd", "#9a917f", "#5d6670"
#: Colours of the rock of regions or segments, in order.
REGIONS = ("#cfc8b8", "#b9c4cc", "#d9cfe0", "#c4d2bd")
#: Line styles of sides and ends by boundary condition: width (points) and dashes.
SIDES: dict[str, tuple[float, Any]] = {
    "free": (1.0, "-"),
    "quiet": (2.2, (0, (3.0, 1.2))),
    "matched": (2.2, (0, (3.0, 1.2, 1.0, 1.2))),
    "fixed": (3.4, "-"),
    "periodic": (1.4, (0, (1.0, 1.5))),
}
MANY = 3000  # lines above which they are an image in the drawing

Point = np.ndarray  # float array [2], m


class Lines(NamedTuple):
    """Lines of one name [n, 2, 2], m, and their style as Line2D takes it."""

    segments: np.ndarray
    style: dict[str, Any]


class Arrow(NamedTuple):
    """An arrow, m; both : with a head at either end."""

    tail: Point
    tip: Point
    colour: str = LOAD
    both: bool = False


class Sketch(NamedTuple):
    """What a drawing shows of a scene, places in m to the right and up.

    low, high : the shown rectangle [2]. stretch : of what is up. axes : their names. size : in
    words. blocks, tones : polygons [corners, 2] and their colours. regions : colours by name.
    lines : in drawing order; a name that begins with "_" is not in the legend. marks : marker and
    places [n, 2] of receivers. notes : place, text and its horizontal alignment.
    """

    low: Point
    high: Point
    stretch: float
    axes: tuple[str, str]
    size: str
    blocks: list[np.ndarray]
    tones: list[str]
    regions: dict[str, str]
    lines: dict[str, Lines]
    marks: dict[str, tuple[str, np.ndarray]]
    arrows: list[Arrow]
    notes: list[tuple[Point, str, str]]

    @property
    def ratio(self) -> float:
        """The height of the drawing over its width."""
        across, up = self.high - self.low
        return float(self.stretch * up / across)


def draw(ax: Axes, sketch: Sketch) -> None:
    """Draw a sketch into axes."""
    many = sum(len(lines.segments) for lines in sketch.lines.values()) > MANY
    rock = PolyCollection(sketch.blocks, facecolors=sketch.tones, rasterized=many, zorder=1)
    ax.add_collection(rock, autolim=False)
    for k, (segments, style) in enumerate(sketch.lines.values()):
        order = {"zorder": 2 + k / 100, "rasterized": many and k == 0}
        ax.add_collection(LineCollection(list(segments), **order, **style), autolim=False)
    for marker, places in sketch.marks.values():
        ax.plot(*places.T, marker, color=RECEIVER, markersize=4.5, zorder=8)
    for arrow in sketch.arrows:
        style = {"arrowstyle": "<|-|>" if arrow.both else "-|>", "color": arrow.colour}
        style |= {"shrinkA": 0, "shrinkB": 0, "linewidth": 1.3}
        ax.annotate("", tuple(arrow.tip), tuple(arrow.tail), arrowprops=style, zorder=6)
    plain = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8}
    for (x, y), text, side in sketch.notes:
        ax.text(x, y, text, ha=side, va="center", fontsize=8, zorder=7, bbox=plain)
    ax.set(xlim=(sketch.low[0], sketch.high[0]), ylim=(sketch.low[1], sketch.high[1]))
    ax.set(aspect=sketch.stretch, anchor="NW")
    right, up = (f"{name} (m)" for name in sketch.axes)
    ax.set(xlabel=": ".join(part for part in (right, sketch.size) if part), ylabel=up)


def legend(sketch: Sketch) -> list[Line2D]:
    """Return the entries of the legend: lines, regions, receivers."""
    entries = [
        Line2D([], [], label=name, **lines.style)
        for name, lines in sketch.lines.items()
        if not name.startswith("_")
    ]
    entries += [
        Line2D([], [], label=name, color=colour, linewidth=6.0)
        for name, colour in sketch.regions.items()
    ]
    entries += [
        Line2D([], [], label=name, color=RECEIVER, marker=marker, linestyle="none", markersize=4.5)
        for name, (marker, _) in sketch.marks.items()
    ]
    return entries


def table(sketch: Sketch) -> pd.DataFrame:
    """Return the ends of every line, and the place of every receiver, with its name."""
    ends = {name.removeprefix("_"): lines.segments for name, lines in sketch.lines.items()}
    ends |= {name: np.stack([places, places], axis=1) for name, (_, places) in sketch.marks.items()}
    columns = [f"{way} {axis} (m)" for way in ("from", "to") for axis in sketch.axes]
    found = pd.DataFrame(np.concatenate([x.reshape(-1, 4) for x in ends.values()]), columns=columns)
    found.insert(0, "what", np.repeat(list(ends), [len(x) for x in ends.values()]))
    return found


def side_style(held: str) -> dict[str, Any]:
    """Return the style of a side or end by its boundary condition."""
    width, dashes = SIDES[held]
    return {"color": INK, "linewidth": width, "linestyle": dashes}


def pushing(tip: Point, direction: Point, length: float | Point, colour: str = LOAD) -> Arrow:
    """Return an arrow of a length (m) along a direction that ends at a place."""
    return Arrow(tip - length * direction, tip, colour)


def shaking(middle: Point, direction: Point, length: float | Point) -> Arrow:
    """Return a double arrow of a length (m) for motion along a direction."""
    half = length / 2 * direction
    return Arrow(middle - half, middle + half, both=True)


def gravity_words(gravity: Gravity | GravityInPlane) -> str:
    """Return the label of the arrow of gravity."""
    return f"{gravity.acceleration:g} m/s²"
