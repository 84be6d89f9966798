"""The paper's figures, drawn from comparisons: one panel a variant and receiver, every curve in it.

Stress in MPa, compression positive, over time in ms, as in Guo & Li (2002).
"""

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.aligned import Beside
from compare.pairs import Comparison
from compare.panels import Panel, panels
from compare.style import FAMILIES, GIVEN, MARKERS, RC, WIDTH, in_order, is_engine, style

#: Factor from SI to the unit that is drawn, and that unit.
UNITS = {
    "stress": (1e-6, "MPa"),
    "shear": (1e-6, "MPa"),
    "velocity": (1.0, "m/s"),
    "rotation": (1e3, "mrad"),
}

MOST_MARKS = 150  # samples of a curve in a panel that are marked one by one


def draw(name: str, comparisons: list[Comparison]) -> Figure:
    """Return a figure of all variants; `name` scopes the ids of its parts ("fig-03").

    The curve of solution S in row i, column j is the SVG group NAME-i-j-S, that of the k-th file of
    others NAME-i-j-given-k.
    """
    grid = panels(comparisons)
    rows, columns = len(grid), max(map(len, grid))
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(WIDTH, 1.0 + rows * (1.75 if rows > 2 else 2.3)))
        FigureCanvasAgg(figure)
        alike = len({UNITS[panel.quantity] for row in grid for panel in row}) == 1
        axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=alike)
        for i, row in enumerate(grid):
            for j, panel in enumerate(row):
                _draw_panel(axes[i, j], panel, f"{name}-{i}-{j}")
                axes[i, j].set_title(
                    f"({chr(97 + i * columns + j)})  {panel.place}, {panel.variant}", pad=4
                )
        _label_axes(axes, grid, alike)
        names = {n for row in grid for panel in row for n in panel.curves}
        add_legend(figure, names, comparisons[0].besides)
    return figure


def _draw_panel(ax: Axes, panel: Panel, gid: str) -> None:
    ax.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=1)
    factor = UNITS[panel.quantity][0]
    for name, curve in panel.curves.items():
        (line,) = ax.plot(1e3 * curve.index, factor * curve.values, **style(name).of_line())
        line.set_gid(f"{gid}-{name}")
    given = panel.given
    for k, beside in enumerate(panel.comparison.besides):
        if beside.curves.name in given:
            curve = given[beside.curves.name]
            (line,) = ax.plot(1e3 * curve.index, factor * curve.values, **_of_given(k, beside))
            line.set_gid(f"{gid}-given-{k}")
    ax.margins(x=0)


def _label_axes(axes: np.ndarray, grid: list[list[Panel]], alike: bool) -> None:
    for row, panels_of_row in zip(axes, grid, strict=True):
        for ax, panel in zip(row[: 1 if alike else None], panels_of_row, strict=False):
            ax.set_ylabel(f"{panel.quantity} ({UNITS[panel.quantity][1]})")
    for ax in axes[-1]:
        ax.set_xlabel("time (ms)")


def _of_given(k: int, beside: Beside) -> dict[str, Any]:
    """Return how the curve of the k-th file of others is drawn, its samples marked if few."""
    look = GIVEN[k % len(GIVEN)].of_line()
    marker = {"marker": MARKERS[k % len(MARKERS)], "markersize": 3.0, "markerfacecolor": "none"}
    return look | marker if len(beside.time) <= MOST_MARKS else look


def add_legend(figure: Figure, names: set[str], besides: list[Beside]) -> None:
    """Put one column of entries per model above the panels, where it hides no curve."""
    columns = [
        [_heading(family), *(_entry(name) for name in styles if name in names)]
        for family, styles in FAMILIES.items()
        if names & set(styles)
    ]
    known = {name for styles in FAMILIES.values() for name in styles}
    if names - known:
        columns.append([_heading("Other"), *(_entry(name) for name in in_order(names - known))])
    if besides:
        entries = [
            Line2D([], [], label=_short(beside.curves.name), **_of_given(k, beside))
            for k, beside in enumerate(besides)
        ]
        columns.append([_heading("Given"), *entries])
    depth = max(map(len, columns))
    handles = [h for column in columns for h in column + [_heading("")] * (depth - len(column))]
    legend = figure.legend(
        handles=handles,
        ncols=len(columns),
        loc="upper center",
        bbox_to_anchor=(0.5, 1.0),
        frameon=False,
        handlelength=4.5,
        columnspacing=4.0,
        labelspacing=0.25,
    )
    for text in legend.get_texts():
        if text.get_text() in (*FAMILIES, "Given"):
            text.set_fontweight("bold")
    top = 1 - (0.16 + 0.165 * depth) / figure.get_figheight()
    figure.tight_layout(rect=(0, 0, 1, top), h_pad=0.8, w_pad=1.5)


def _heading(text: str) -> Line2D:
    return Line2D([], [], linestyle="none", label=text)


def _short(file: str) -> str:
    """Return a file's name as a legend has room for; a dollar sign would begin a formula."""
    return (file if len(file) <= 28 else f"{file[:12]}…{file[-15:]}").replace("$", r"\$")


def _entry(name: str) -> Line2D:
    kind = "engine" if is_engine(name) else "exact"
    return Line2D([], [], label=f"{name} ({kind})", **style(name).of_line())
