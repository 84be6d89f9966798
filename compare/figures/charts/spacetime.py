"""Space-time diagrams: y along the pillar over time, the motion as colour."""

from functools import partial
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cases.schema.scene import Scene
from compare.figures.charts.spacetime_data import Diagram, Diagrams
from compare.figures.export import blank
from compare.figures.figure import SceneFigure
from compare.figures.style import WIDTH

HEIGHT = 3.1  # inches
LEFT, RIGHT, BETWEEN = 0.6, 0.15, 0.3  # inches beside the diagrams, and between two of them
TOP, BOTTOM = 0.58, 0.82  # inches above and below them: headings, times and colours
KEY, THICK = 0.26, 0.06  # inches: position and height of the colour bar
COLOURS = 96  # of an image in print
FINER = 2  # rows of the image per interval of places
LAYER: dict[str, Any] = {"color": "#111111", "linewidth": 1.1, "linestyle": (0, (4, 3))}
NAMED: dict[str, Any] = {
    "xycoords": ("axes fraction", "data"),
    "xytext": (0, 2),
    "textcoords": "offset points",
    "ha": "right",
    "fontsize": 7,
}


def space_time(name: str, scene: Scene, variant: str, shown: Diagrams) -> SceneFigure:
    """Return the figure of one variant's diagrams; those of numerical errors are folded.

    name : unique on the page. variant : its name there.
    """
    words = f"{shown.quantity.words} along the pillar over time, {variant}"
    title = f"Numerical error of {words}" if shown.exact else f"{words[0].upper()}{words[1:]}"
    return SceneFigure(
        name,
        title,
        _caption(scene, variant, shown),
        partial(_figure, scene, shown),
        shown.table(),
        shown.exact,
    )


def _caption(scene: Scene, variant: str, shown: Diagrams) -> str:
    """Describe the colours, and the places and times of their values."""
    sign = "Compression is red, tension blue. " if shown.quantity.variable == "stress" else ""
    layers = " Dashed: the soft layer." if scene.soft_layers else ""
    if shown.exact:
        sign = "Each engine minus the exact solution of its own model. "
    return (
        f"{sign}Drawn from {len(shown.y)} places and {len(shown.time)} times of the variant "
        f"{variant!r}, minus its static state; a difference has its own colour scale, up to its "
        f"largest value.{layers}"
    )


def _figure(scene: Scene, shown: Diagrams) -> Figure:
    with blank(HEIGHT, laid_out=True) as figure:
        columns = max(len(shown.diagrams), 2)
        across = (WIDTH - LEFT - RIGHT - BETWEEN * (columns - 1)) / columns
        axes: list[Axes] = []
        for i, diagram in enumerate(shown.diagrams):
            left = LEFT + i * (across + BETWEEN)
            place, key = (
                (left / WIDTH, low / HEIGHT, across / WIDTH, high / HEIGHT)
                for low, high in ((BOTTOM, HEIGHT - BOTTOM - TOP), (KEY, THICK))
            )
            axes.append(figure.add_axes(place, sharex=axes[0] if i else None))
            _draw(axes[i], figure.add_axes(key), diagram, shown, scene)
            axes[i].tick_params(labelleft=i == 0)
        for layer in scene.soft_layers:
            axes[0].annotate("soft layer", (0.99, layer.y), **NAMED)
        axes[0].set_ylabel("y (m)")
    return figure


def _draw(ax: Axes, key: Axes, diagram: Diagram, shown: Diagrams, scene: Scene) -> None:
    time, y = 1e3 * shown.time[[0, -1]], shown.y[[0, -1]]
    values = evenly(shown.y, diagram.values)
    rows, columns = values.shape
    # An image's extent is that of its pixels' edges: its points are half a pixel inside.
    x_edge, y_edge = np.ptp(time) / (columns - 1) / 2, np.ptp(y) / (rows - 1) / 2
    image = ax.imshow(
        values,
        # A palette, without interpolated points: files are 20 times smaller.
        cmap=matplotlib.colormaps[diagram.colours].resampled(COLOURS),
        interpolation="none",
        vmin=-diagram.limit,
        vmax=diagram.limit,
        extent=(time[0] - x_edge, time[1] + x_edge, y[0] - y_edge, y[1] + y_edge),
        origin="lower",
        aspect="auto",
    )
    ax.set(xlim=time, ylim=y)
    for layer in scene.soft_layers:
        ax.axhline(layer.y, **LAYER)
    ax.set_title(diagram.heading, pad=4)
    ax.set_xlabel("time (ms)")
    bar = key.figure.colorbar(image, cax=key, orientation="horizontal")
    bar.outline.set_linewidth(0.5)
    bar.set_ticks(MaxNLocator(4, symmetric=True))  # few, so that long numbers do not overlap


def evenly(y: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values [place, time] at equally spaced places, as images require: `FINER` rows per
    interval between places."""
    places = np.linspace(y[0], y[-1], FINER * (len(y) - 1) + 1)
    return np.stack([np.interp(places, y, column) for column in values.T], axis=1)
