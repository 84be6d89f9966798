"""Drawn maps of bodies: beside each other on one colour scale, and the difference of two."""

from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from jointwave.cases.errors import require
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import in_order
from jointwave.compare.figures.animation.bodies import colours_of
from jointwave.compare.figures.animation.settings import SLIP, stretch_of
from jointwave.compare.figures.body_maps import Map, difference, maps_of, scene_of
from jointwave.compare.figures.charts.axes import LETTER
from jointwave.compare.figures.drawing.sketch import MANY, ROCKS
from jointwave.compare.figures.export import SceneFigure, blank
from jointwave.compare.figures.style import DIFFERENCE, RC, SIZE, printed
from jointwave.compare.figures.variants import named
from jointwave.compare.misfit.pairs import Comparison
from jointwave.results.dataset import A_RESULT

FLAT = 0.4  # height over width of a body, below which maps are one below the other
TALLEST = 0.7  # height of a single map over the width of the figure
BAR, TITLE, BESIDE = 0.9, 0.25, 0.7  # inches: of a colour bar, above a map, and beside it
JOINT, WIDTH = "#333333", 60.0  # colour of joints; width (points) of all of them together
SLIPPED = 1.6  # points, width of joints with the colour of their slip
PEAKS = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): peaks between snapshots are missed."
)


def plot_map(
    result: xr.Dataset,
    quantity: str = "ppv",
    other: xr.Dataset | None = None,
    time: float | None = None,
    width: float = 190.0,
    font_size: float = 8.0,
) -> Figure:
    """Return the map of a quantity over a result's body, or of two results and their difference.

    result, other : with snapshots (`record.fields`), of one body. quantity : "ppv", the largest
    particle velocity over all snapshots; "speed"; "stress", along a pillar, else the principal
    stress of larger size in the plane; "slip" of joints. time : s, of the snapshot; None: that in
    which the mean square is largest. width : of the figure, mm. font_size : points.

    Both results share one colour scale. Where few values are far beyond it, the colour bar ends in
    an arrow and says how much of the body they are. The difference is the second less the first.
    Raises SceneError without snapshots, for another quantity or time, and for different bodies.
    """
    given = [result] if other is None else [result, other]
    for one in given:
        require(one, xr.Dataset, "plot_map", "type", A_RESULT)
    scene = scene_of(result)
    return draw_maps(maps_of(scene, given, quantity, time), scene, printed(width, font_size))


def draw_maps(maps: dict[str, Map], scene: AnyScene, rc: dict[Any, Any] = RC) -> Figure:
    """Return maps of one scene by name: side by side, flat ones one below the other."""
    first, count = next(iter(maps.values())), len(maps)
    across, up = np.ptp(first.corners, axis=(0, 1))
    with blank(1.0, rc=rc) as figure:
        ratio, parts = float(stretch_of(scene) * up / across), 1 + (count == 2)
        axes = _axes(figure, ratio, count + parts - 1, parts)
        colours = colours_of([one.values for one in maps.values()], first.quantity.sign)
        _draw(figure, axes[:count], maps, colours, first.quantity.label)
        if count == 2:
            (a, one), (b, other) = maps.items()
            less = {f"{b} − {a}": difference(one, other)}
            colours = colours_of([*(one.values for one in less.values())], "signed", DIFFERENCE)
            unit = first.quantity.name.partition(" (")[2]
            _draw(figure, axes[count:], less, colours, f"difference ({unit}")
        _label(figure, axes, scene, first.time)
    return figure


def _axes(figure: Figure, ratio: float, count: int, bars: int) -> list[Axes]:
    """Return axes of maps with a height over width, in a figure of the height that they need."""
    inch, width = rcParams["font.size"] / SIZE, figure.get_figwidth()
    room = width - BESIDE * inch
    if ratio < FLAT:
        axes = figure.subplots(count, 1, squeeze=False)[:, 0]
        height = count * (ratio * room + 2 * TITLE * inch) + bars * BAR * inch
    else:
        axes = figure.subplots(1, count, sharey=True, squeeze=False)[0]
        height = min(ratio * room / count, TALLEST * width) + (BAR + 2 * TITLE) * inch
    figure.set_figheight(height + TITLE * inch)
    return list(axes)


def _draw(
    figure: Figure, axes: list[Axes], maps: dict[str, Map], colours: ScalarMappable, label: str
) -> None:
    """Draw maps by name into axes, and their colour bar below."""
    columns = axes[0].get_subplotspec().get_gridspec().ncols  # type: ignore[union-attr]
    share, shrink = (len(axes) / columns, 1.0) if columns > 1 else (1.0, 0.6)
    letters = _letters() * share * (figure.get_figwidth() - BESIDE)
    for ax, (name, one) in zip(axes, maps.items(), strict=True):
        _draw_one(ax, one, colours)
        wide = letters / (len(axes) if columns > 1 else 1)
        ax.set_title(fill(name, int(wide)), parse_math=False)
    words = fill(label, int(letters)) + _beyond(list(maps.values()), colours)
    look: dict[str, Any] = {"location": "bottom", "aspect": 40, "shrink": shrink}
    bar = figure.colorbar(colours, ax=axes, label=words, **look)
    bar.locator = MaxNLocator(min(6, int(letters / 10)))


def _letters() -> float:
    """Return about how many letters an inch holds."""
    return 72 / (LETTER * rcParams["font.size"])


def _label(figure: Figure, axes: list[Axes], scene: AnyScene, time: float | None) -> None:
    """Add the heading and the labels of the axes."""
    words = ", ".join(part for part in (scene.title, scene.name) if part)
    if time is not None:
        words += f", at {1e3 * time:.4g} ms"
    words = fill(words, int(_letters() * figure.get_figwidth()))
    figure.suptitle(words, x=0.01, ha="left", parse_math=False)
    stretch = stretch_of(scene)
    thicker = f"; thickness × {stretch:.2g}" * (stretch > 1.01)
    for ax in axes:
        ax.set(aspect=stretch, anchor="SW" if len(axes) > 1 else "S")
        if scene.is_column:
            ax.set(xlabel=f"y (m){thicker}", yticks=[])
            ax.spines["left"].set_visible(False)
        else:
            ax.set(xlabel="x (m)", ylabel="y (m)")
        ax.label_outer()


def _draw_one(ax: Axes, one: Map, colours: ScalarMappable) -> None:
    """Draw a map into axes, its joints above it."""
    faces = PolyCollection(list(one.corners), rasterized=len(one.corners) > MANY)
    if one.quantity == SLIP:
        faces.set(facecolor=ROCKS[0], edgecolor="face")
        order = np.abs(one.values).argsort()  # the largest is drawn last
        one = one._replace(joints=one.joints[order], values=one.values[order])
        edges = LineCollection(list(one.joints), linewidth=SLIPPED, capstyle="round")
    else:
        faces.set(edgecolor="face", linewidth=0.4, antialiased=False)
        width = min(0.4, WIDTH / max(1, len(one.joints)))
        edges = LineCollection(list(one.joints), linewidth=width, color=JOINT)
    valued = edges if one.quantity == SLIP else faces
    valued.set(array=one.values, cmap=colours.get_cmap(), norm=colours.norm)
    for shape in (faces, edges):
        ax.add_collection(shape)
    (left, low), (right, high) = one.corners.min((0, 1)), one.corners.max((0, 1))
    ax.set(xlim=(left, right), ylim=(low, high))


def _beyond(maps: list[Map], colours: ScalarMappable) -> str:
    """Return how much of the bodies the colours do not resolve, in words; "" if nothing."""
    most = colours.get_clim()[1] * (1 + 1e-9)
    sizes = np.concatenate([one.sizes for one in maps])
    share = sizes @ (np.abs(np.concatenate([one.values for one in maps])) > most) / sizes.sum()
    of = "length" if maps[0].quantity == SLIP else "area"
    return f"\n{100 * share:.2g} % of the {of} is beyond" if share else ""


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps of peak velocity, one figure per variant; empty for a pillar, or without
    snapshots of a whole field."""
    found = []
    for k, (variant, one) in enumerate(named(comparisons)):
        results = [one.results[engine] for engine in in_order(one.results)]
        results = [result for result in results if "field_velocity" in result]
        if not one.scene.is_column and results:
            maps = maps_of(one.scene, results, "ppv")
            title, stem = f"Peak particle velocity, {variant}", f"{name}-peak-velocity-{k}"
            drawn = draw_maps(maps, one.scene)
            found.append(SceneFigure(stem, title, PEAKS, drawn, _table(maps), bool(k)))
    return found


def _table(maps: dict[str, Map]) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame({"engine": name, "x (m)": x, "y (m)": y, "peak velocity (m/s)": one.values})
        for name, one in maps.items()
        for x, y in [one.corners.mean(axis=1).T]
    ]
    return pd.concat(parts, ignore_index=True)
