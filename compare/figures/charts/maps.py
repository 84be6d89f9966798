"""Maps of bodies with a common colour scale, and the difference of two maps."""

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
from jointwave.compare.figures.animation.snapshots import SLIP
from jointwave.compare.figures.body_maps import Map, difference, maps_of, scene_of
from jointwave.compare.figures.drawing.sketch import MANY, ROCKS
from jointwave.compare.figures.export import LETTER, SceneFigure, blank, label_ends
from jointwave.compare.figures.receivers import named
from jointwave.compare.figures.style import DIFFERENCE, RC, SIZE, printed
from jointwave.compare.misfit.pairs import Comparison
from jointwave.results.dataset import A_RESULT

FLAT = 0.4  # height over width of a body, below which maps are one below the other
TALLEST = 0.7  # height of a single map over the width of the figure
BAR, TITLE, BESIDE = 0.9, 0.25, 0.7  # inches of a colour bar, above a map, beside it
JOINT, WIDTH = "#333333", 60.0  # colour of joints; sum of the widths of all joints, points
SLIPPED = 1.6  # width of joints coloured by slip, points
PEAKS = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): peaks between snapshots are missed."
)


def plot_map(
    result: xr.Dataset,
    quantity: str = "ppv",
    other: xr.Dataset | None = None,
    time: float | None = None,
    section: str | None = None,
    width: float = 190.0,
    font_size: float = 8.0,
) -> Figure:
    """Return the map of a quantity over a result's body, or of two results and their difference.

    result, other : with snapshots (`record.fields`), of the same body. quantity : "ppv", the
    largest particle velocity over all snapshots; "speed"; "stress", axial in a pillar, else the
    principal stress of larger magnitude (in the plane of a plane scene); "slip" of joints. time :
    of the snapshot, s; None: the one with the largest mean square. section : of a rock mass in
    space, as "y=25", in m; None: normal to y through the middle of the openings, else the front.
    Along a face it shows the rock behind. width : of the figure, mm. font_size : points.

    Both results share one colour scale. If few values far exceed it, the colour bar ends in an
    arrow and states their share of the body. The difference is the second minus the first.
    Raises SceneError without snapshots, for another quantity or time, and for different bodies.
    """
    given = [result] if other is None else [result, other]
    for one in given:
        require(one, xr.Dataset, "plot_map", "type", A_RESULT)
    scene = scene_of(result)
    maps = maps_of(scene, given, quantity, time, section)
    return draw_maps(maps, scene, printed(width, font_size))


def draw_maps(maps: dict[str, Map], scene: AnyScene, rc: dict[Any, Any] = RC) -> Figure:
    """Draw the maps of one scene, with names: side by side, or if flat one below the other."""
    first, every, less = next(iter(maps.values())), [*maps.values()], dict[str, Map]()
    if len(maps) == 2:
        less = {" − ".join(reversed(maps)): difference(*every)}
    across, up = np.ptp(first.corners, axis=(0, 1))
    ratio, count, bars = float(first.stretch * up / across), len(maps) + len(less), 1 + len(less)
    with blank(1.0, rc=rc) as figure:
        inch, width = rcParams["font.size"] / SIZE, figure.get_figwidth()
        room = width - BESIDE * inch
        if ratio < FLAT:
            axes = figure.subplots(count, 1, squeeze=False)[:, 0]
            height = count * (ratio * room + 2 * TITLE * inch) + bars * BAR * inch
        else:
            axes = figure.subplots(1, count, sharey=True, squeeze=False)[0]
            height = min(ratio * room / count, TALLEST * width) + (BAR + 2 * TITLE) * inch
        figure.set_figheight(height + TITLE * inch)
        letters = 72 / (LETTER * rcParams["font.size"])  # per inch
        _draw(axes[: len(maps)], maps, first.quantity.sign, None, first.quantity.label, letters)
        if less:
            unit = f"difference ({first.quantity.name.partition(' (')[2]}"
            _draw(axes[len(maps) :], less, "signed", DIFFERENCE, unit, letters)
        words = ", ".join(part for part in (scene.title, scene.name, *first.words) if part)
        title = fill(words, int(letters * width))
        figure.suptitle(title, x=0.01, ha="left", parse_math=False)
        right, upwards = first.axes
        thicker = f"; thickness × {first.stretch:.2g}" * (first.stretch > 1.01)
        for ax in axes:
            ax.set(aspect=first.stretch, anchor="SW" if count > 1 else "S")
            ax.set(xlabel=f"{right} (m){thicker}", ylabel=f"{upwards} (m)" * bool(upwards))
            if not upwards:
                ax.set(yticks=[])
                ax.spines["left"].set_visible(False)
            label_ends(ax)
            ax.label_outer()
    return figure


def _draw(
    axes: Any, maps: dict[str, Map], sign: str, hues: str | None, label: str, letters: float
) -> None:
    """Draw maps by name into axes, with a colour bar below; letters : per inch."""
    every, figure = [*maps.values()], axes[0].figure
    columns = axes[0].get_subplotspec().get_gridspec().ncols
    values, sizes = [one.values for one in every], [one.sizes for one in every]
    colours, beyond = colours_of(values, sign, hues, sizes)
    share, shrink = (len(axes) / columns, 1.0) if columns > 1 else (1.0, 0.6)
    letters *= share * (figure.get_figwidth() - BESIDE)
    for ax, (name, one) in zip(axes, maps.items(), strict=True):
        _draw_one(ax, one, colours)
        wide = letters / (len(axes) if columns > 1 else 1)
        ax.set_title(fill(name, int(wide)), parse_math=False)
    of = "length" if every[0].quantity == SLIP else "area"
    words = fill(label, int(letters))
    words += f"\n{100 * beyond:.2g} % of the {of} is beyond" if beyond else ""
    look: dict[str, Any] = {"location": "bottom", "aspect": 40, "shrink": shrink}
    bar = figure.colorbar(colours, ax=axes, label=words, **look)
    bar.locator = MaxNLocator(min(6, int(letters / 10)))


def _draw_one(ax: Axes, one: Map, colours: ScalarMappable) -> None:
    """Draw a map into axes, with joints on top."""
    faces = PolyCollection(list(one.corners), rasterized=len(one.corners) > MANY)
    valued: PolyCollection | LineCollection = faces
    if one.quantity == SLIP:
        faces.set(facecolor=ROCKS[0], edgecolor="face")
        order = np.abs(one.values).argsort()  # largest last, on top
        one = one._replace(joints=one.joints[order], values=one.values[order])
        edges = LineCollection(list(one.joints), linewidth=SLIPPED, capstyle="round")
        valued = edges
    else:
        faces.set(edgecolor="face", linewidth=0.4, antialiased=False)
        width = min(0.4, WIDTH / max(1, len(one.joints)))
        edges = LineCollection(list(one.joints), linewidth=width, color=JOINT)
    valued.set(array=one.values, cmap=colours.get_cmap(), norm=colours.norm)
    ax.add_collection(faces)
    ax.add_collection(edges)
    (left, low), (right, high) = one.corners.min((0, 1)), one.corners.max((0, 1))
    ax.set(xlim=(left, right), ylim=(low, high))


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return a map of peak velocity per variant, for a rock mass with snapshots."""
    found = []
    for k, (variant, one) in enumerate(named(comparisons)):
        results = [one.results[engine] for engine in in_order(one.results)]
        results = [result for result in results if "field_velocity" in result]
        if len(one.scene.axes) > 1 and results:
            maps = maps_of(one.scene, results, "ppv")
            right, up = next(iter(maps.values())).axes
            columns = "engine", f"{right} (m)", f"{up} (m)", "peak velocity (m/s)"
            parts = [
                pd.DataFrame(
                    dict(zip(columns, (n, *m.corners.mean(axis=1).T, m.values), strict=True))
                )
                for n, m in maps.items()
            ]
            title, stem = f"Peak particle velocity, {variant}", f"{name}-peak-velocity-{k}"
            drawn, table = draw_maps(maps, one.scene), pd.concat(parts, ignore_index=True)
            found.append(SceneFigure(stem, title, PEAKS, drawn, table, bool(k)))
    return found
