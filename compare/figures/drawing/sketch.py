"""A scene as matplotlib shapes in metres: shapes common to pillars and rock masses, and receivers,
waves, loads, gravity and prestress of a rock mass."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.text import Annotation, Text
from matplotlib.transforms import IdentityTransform

from jointwave.cases.partition.shape import Shape
from jointwave.cases.schema.pulse import PlaneLoad
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.figures.export import label_ends
from jointwave.results.stress import stress_components

INK, LOAD, RECEIVER = "#1c2126", "#b3001b", "#00549e"
EDGE, SOFT = "#9a917f", "#5d6670"
#: Colours of the rock, then of regions or segments in order.
ROCKS = ("#efe9dd", "#cfc8b8", "#b9c4cc", "#d9cfe0", "#c4d2bd")
#: Line styles of sides and ends by boundary condition: width (points) and dashes.
SIDES: dict[str, tuple[float, Any]] = {
    "free": (1.0, "-"),
    "quiet": (2.2, (0, (3.0, 1.2))),
    "matched": (2.2, (0, (3.0, 1.2, 1.0, 1.2))),
    "fixed": (3.4, "-"),
    "roller": (3.4, (0, (0.6, 0.6))),
    "periodic": (1.4, (0, (1.0, 1.5))),
}
#: Colours of joint sets, in order, distinguishable with any colour blindness (Tol 2021, bright).
SETS = ("#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee")
LENGTH, SHORT = 0.12, 0.05  # length of arrows of waves and others, over the domain's size
MOST = 12  # arrows of a pressure on one edge
MANY = 3000  # lines or blocks of one name above which they are rasterised


class Sketch(NamedTuple):
    """The drawing of a scene; coordinates (right, up), m.

    shapes : from the functions below, in drawing order; names that begin with "_" are not in the
    legend. low, high : corners of the shown rectangle [2]. axes : their names. stretch : factor of
    the upward coordinate. size : in words. ticks : axes with ticks, of "xy". image : of the
    rectangle [h, w, 4], below all shapes, or None.
    """

    shapes: list[Artist]
    low: np.ndarray
    high: np.ndarray
    axes: tuple[str, str]
    stretch: float = 1.0
    size: str = ""
    ticks: str = "xy"
    image: np.ndarray | None = None

    @property
    def ratio(self) -> float:
        """The height of the drawing over its width."""
        across, up = self.high - self.low
        return float(self.stretch * up / across)

    def draw(self, ax: Axes) -> None:
        """Draw the scene into axes."""
        for shape in self.shapes:
            ax.add_artist(shape)
        right, up = (f"{name} (m)" for name in self.axes)
        ax.set(xlabel=f"{right}{self.size}", ylabel=up, aspect=self.stretch, anchor="S")
        if self.image is not None:
            ax.imshow(self.image, extent=(self.low[0], self.high[0], self.low[1], self.high[1]))
        if "y" not in self.ticks:
            ax.set(yticks=[], ylabel=self.axes[1])
            ax.spines["left"].set_visible(False)
        if not self.ticks:
            ax.set(xlabel=self.size, ylabel="", xticks=[], frame_on=False)
        ax.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]))
        if self.ticks:
            label_ends(ax)

    def table(self) -> pd.DataFrame:
        """Return the ends of every line, and the position of every receiver, with its name."""
        columns = [f"{way} {axis} (m)" for way in ("from", "to") for axis in self.axes]
        parts = []
        for shape in self.shapes:
            if isinstance(shape, LineCollection):
                ends = np.array(shape.get_segments()).reshape(-1, 4)
            elif isinstance(shape, Line2D):
                ends = np.tile(shape.get_xydata(), 2)
            else:
                continue
            parts.append(pd.DataFrame(ends, columns=columns))
            parts[-1].insert(0, "what", str(shape.get_label()).removeprefix("_"))
        return pd.concat(parts)


def rock(name: str, polygons: list[np.ndarray], k: int) -> Artist:
    """Return the blocks of the k-th rock from polygons [corners, 2], m."""
    style: Any = {"facecolors": ROCKS[k % len(ROCKS)], "zorder": 1}
    return PolyCollection(polygons, label=name, rasterized=len(polygons) > MANY, **style)


def lines(name: str, segments: Any, colour: str, width: float, dashes: Any = "-") -> list[Artist]:
    """Return lines [n, 2, 2], m; none if there are none."""
    style: Any = {"colors": colour, "linewidths": width, "linestyles": [dashes], "zorder": 2}
    found = LineCollection(list(segments), label=name, rasterized=len(segments) > MANY, **style)
    return [found] if len(segments) else []


def side(name: str, segments: Any, kind: str) -> list[Artist]:
    """Return the lines of a side or end with a boundary condition."""
    return lines(f"{kind} {name}", segments, INK, *SIDES[kind])


def receivers(name: str, places: Any, marker: str) -> list[Artist]:
    """Return the markers of receivers at positions [n, 2], m; none if there are none."""
    style: Any = {"color": RECEIVER, "markersize": 4.5, "linestyle": "none", "zorder": 8}
    return [Line2D(*np.transpose(places), marker=marker, label=name, **style)] if places else []


def arrow(tail: np.ndarray, tip: np.ndarray, colour: str = LOAD, heads: str = "-|>") -> Artist:
    """Return an arrow between two points, m."""
    style = {"arrowstyle": heads, "color": colour, "linewidth": 1.3, "shrinkA": 0, "shrinkB": 0}
    end, start = (tip[0], tip[1]), (tail[0], tail[1])
    return Annotation("", end, start, arrowprops=style, transform=IdentityTransform(), zorder=6)


def pushing(tip: np.ndarray, direction: np.ndarray, length: Any, colour: str = LOAD) -> Artist:
    """Return an arrow of a length, m, along a direction, that ends at a point."""
    return arrow(tip - length * direction, tip, colour)


def shaking(middle: np.ndarray, direction: np.ndarray, length: Any) -> Artist:
    """Return a double arrow of a length (m) for motion along a direction."""
    half = length / 2 * direction
    return arrow(middle - half, middle + half, heads="<|-|>")


def gravity(tip: np.ndarray, down: np.ndarray, length: Any, acceleration: float) -> list[Artist]:
    """Return the arrow of gravity, which ends at a point, and its value (m/s²) to the left."""
    words = note(tip - 1.3 * length * np.array([1.0, 0.0]), f"{acceleration:g} m/s²", "right")
    return [pushing(tip, down, length, SOFT), words] if acceleration else []


def note(at: np.ndarray, text: str, align: str) -> Artist:
    """Return text at a point, m, with horizontal alignment."""
    plain = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8}
    return Text(at[0], at[1], text, ha=align, va="center", fontsize=8, zorder=7, bbox=plain)


def surroundings(
    scene: RockMass, domain: Shape, onto: np.ndarray, size: float, wide: float = 1.0
) -> list[Artist]:
    """Return the shapes of receivers, waves, loads, gravity and prestress.

    onto : projection [2, d] onto the drawing. size : length that scales arrows, m. wide : factor by
    which blocks are moved apart in the drawing.
    """
    middle, record = (domain.low + domain.high) / 2, scene.record

    def seen(place: np.ndarray) -> np.ndarray:
        return onto @ (middle + wide * (place - middle))

    shapes = [
        *receivers("point", [onto @ one for one in record.points], "o"),
        *receivers("point of a joint", [onto @ one for one in record.joints], "^"),
    ]
    half = wide * (domain.high - domain.low) / 2
    for wave in scene.waves:
        n, along = np.array(wave.direction), onto @ wave.direction
        left = np.array([-along[1], along[0]])
        with np.errstate(divide="ignore"):  # the point where a ray to the middle enters
            tip = middle - (float(np.min(half / np.abs(n))) + 0.01 * size) * n
        at = onto @ (tip - LENGTH / 2 * size * n)
        if wave.kind == "S":
            moved = left if wave.polarisation is None else onto @ wave.polarisation
            shapes.append(shaking(at - 0.06 * size * left, moved, 0.1 * size))
        shapes.append(pushing(onto @ tip, along, LENGTH * size))
        shapes.append(note(at + 0.045 * size * left, wave.kind, "center"))
    for load in scene.loads:
        length, direction = 1.5 * SHORT * size, onto @ (load.direction or 0 * middle)
        if load.kind == "force":
            shapes.append(pushing(seen(np.array(load.at)), direction, length))
        elif load.kind == "base":
            corners = np.concatenate([one for one, _ in domain.faces_of(load.side)])
            at = seen((corners.min(axis=0) + corners.max(axis=0)) / 2)
            shapes.append(shaking(at, direction, 2 * SHORT * size))
        elif load.side or len(onto.T) == 2:  # openings in space are hidden
            for tip, normal, long in _pressure(load, domain, size):
                shapes.append(pushing(seen(tip), onto @ normal, long))
    places = np.concatenate([corners for corners, _ in domain.faces]) @ onto.T
    low, high = places.min(axis=0), places.max(axis=0)
    above = high[1] + 0.4 * LENGTH * size
    if scene.gravity is not None:
        at, down = np.array([low[0] + 0.2 * size, above]), onto @ scene.gravity.direction
        shapes += gravity(at, down, SHORT * size, scene.gravity.acceleration)
    if scene.prestress is not None:
        parts = [scene.prestress.tensor[ij] for ij in stress_components(len(middle)).values()]
        words = f"prestress {', '.join(f'{part / 1e6:g}' for part in parts)} MPa"
        shapes.append(note(np.array([high[0], above]), words, "right"))
    return shapes


def _pressure(
    load: PlaneLoad, domain: Shape, size: float
) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Yield tip, direction and length of the arrows of a pressure: in the plane as many as fit
    along an edge, in space one per face."""
    for corners, normal in domain.faces_of(load.side, load.opening):
        inwards = -normal if load.opening is None else normal
        if len(normal) == 3:
            yield corners.mean(axis=0), inwards, LENGTH * size
            continue
        length = float(np.linalg.norm(corners[1] - corners[0]))
        count = int(np.clip(round(length / (SHORT * size)), 1, MOST))
        for part in (np.arange(count) + 0.5) / count:
            yield corners[0] + part * (corners[1] - corners[0]), inwards, 0.7 * SHORT * size
