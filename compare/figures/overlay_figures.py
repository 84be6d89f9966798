"""Overlays as figures for print: waveforms in one pair of axes each, what they leave from their
reference under them, and a legend above all.

Stress in MPa, compression positive, over time in ms, as in Guo & Li (2002).
"""

from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.figures.overlays import UNITS, Overlay, Trace, by_solution, legend_of
from compare.figures.style import FAMILIES, RC, WIDTH, in_order, is_engine, style
from compare.figures.subplots import in_page, panels
from compare.misfit.pairs import Comparison

__all__ = ["UNITS", "add_legend", "draw", "draw_variants"]

HEIGHT, SMALLER, RESIDUAL = 2.1, 1.6, 0.75  # inches of a panel, of many, and of its residuals
THIN = 1.4  # points, the widest line of residuals


def draw(name: str, comparisons: list[Comparison]) -> Figure:
    """Return every solution of all variants; `name` scopes the ids of its parts ("fig-03").

    The curve of solution S in row i, column j is the SVG group NAME-i-j-S, that of the k-th file of
    others NAME-i-j-given-k, and the residual of S NAME-residual-i-j-S.
    """
    grid = [[by_solution(panel) for panel in row] for row in in_page(panels(comparisons))]
    with matplotlib.rc_context(RC):
        figure = _figure(name, grid)
        names = {name for comparison in comparisons for name in comparison.results}
        given = {t.part: t for row in grid for o in row for t in o.traces if t.part not in names}
        add_legend(figure, names, list(given.values()))
    return figure


def draw_variants(name: str, grid: list[list[Overlay]]) -> Figure:
    """Return the variants of every engine in one pair of axes each."""
    with matplotlib.rc_context(RC):
        figure = _figure(name, grid)
        entries = legend_of(overlay for row in grid for overlay in row)
        handles = [Line2D([], [], label=text, **look.of_line()) for text, look in entries.items()]
        figure.legend(
            handles=handles,
            ncols=len(handles),
            loc="upper center",
            bbox_to_anchor=(0.5, 1.0),
            frameon=False,
            handlelength=3.5,
        )
        _lay_out(figure, 1)
    return figure


def _figure(name: str, grid: list[list[Overlay]]) -> Figure:
    """Return the figure of overlays without its legend."""
    rows, columns = len(grid), max(map(len, grid))
    heights = [SMALLER if rows > 2 else HEIGHT]
    heights += [RESIDUAL] if any(o.residuals for row in grid for o in row) else []
    figure = Figure(figsize=(WIDTH, 0.9 + rows * (sum(heights) + 0.2 * len(heights))))
    FigureCanvasAgg(figure)
    every = len(heights)
    axes = figure.subplots(
        every * rows, columns, squeeze=False, sharex=True, height_ratios=heights * rows
    )
    alike = len({overlay.label for row in grid for overlay in row}) == 1
    for i, row in enumerate(grid):
        for j, overlay in enumerate(row):
            upper, *lower = axes[every * i : every * (i + 1), j]
            if alike and (i or j):
                upper.sharey(axes[0, 0])
            _draw(upper, overlay, f"{name}-{i}-{j}")
            letter = f"({chr(97 + i * columns + j)})  " if i * columns + j < 26 else ""
            upper.set_title(f"{letter}{overlay.heading}", pad=4)
            if j == 0 or not alike:
                upper.set_ylabel(overlay.label)
            for ax in lower:
                _draw_residuals(ax, overlay, f"{name}-residual-{i}-{j}")
        for ax in axes[every * i : every * (i + 1), len(row) :].ravel():
            ax.set_visible(False)
    for ax in axes[-1]:
        ax.set_xlabel("time (ms)")
    return figure


def _draw(ax: Axes, overlay: Overlay, gid: str) -> None:
    ax.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=1)
    for trace in overlay.traces:
        line = trace.look.of_line() | _marked(trace)
        (drawn,) = ax.plot(1e3 * trace.curve.index, overlay.factor * trace.curve.values, **line)
        drawn.set_gid(f"{gid}-{trace.part}")
    ax.margins(x=0)


def _draw_residuals(ax: Axes, overlay: Overlay, gid: str) -> None:
    """Draw what waveforms leave from their reference, on a scale of its own."""
    ax.set_title(overlay.residual_heading, pad=2, fontsize=8)
    ax.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=1)
    for trace in overlay.residuals:
        assert trace.residual is not None
        look = trace.look._replace(width=min(trace.look.width, THIN)).of_line()
        values = trace.residual.values / overlay.unit.size
        (drawn,) = ax.plot(1e3 * trace.residual.index, values, **look)
        drawn.set_gid(f"{gid}-{trace.part}")
    ax.margins(x=0)
    ax.locator_params(axis="y", nbins=4)
    if not overlay.residuals:
        ax.set_yticks([])


def _marked(trace: Trace) -> dict[str, Any]:
    if not trace.marker:
        return {}
    return {"marker": trace.marker, "markersize": 3.0, "markerfacecolor": "none"}


def add_legend(figure: Figure, names: set[str], given: list[Trace]) -> None:
    """Put one column of entries per model above the panels, where it hides no curve."""
    columns = [
        [_heading(family), *(_entry(name) for name in styles if name in names)]
        for family, styles in FAMILIES.items()
        if names & set(styles)
    ]
    known = {name for styles in FAMILIES.values() for name in styles}
    if names - known:
        columns.append([_heading("Other"), *(_entry(name) for name in in_order(names - known))])
    if given:
        entries = [
            Line2D([], [], label=_short(t.name), **t.look.of_line() | _marked(t)) for t in given
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
    _lay_out(figure, depth)


def _lay_out(figure: Figure, depth: int) -> None:
    """Give the panels the room below a legend of so many lines."""
    top = 1 - (0.16 + 0.165 * depth) / figure.get_figheight()
    figure.tight_layout(rect=(0, 0, 1, top), h_pad=0.5, w_pad=1.5)


def _heading(text: str) -> Line2D:
    return Line2D([], [], linestyle="none", label=text)


def _short(file: str) -> str:
    """Return a file's name as a legend has room for; a dollar sign would begin a formula."""
    return (file if len(file) <= 28 else f"{file[:12]}…{file[-15:]}").replace("$", r"\$")


def _entry(name: str) -> Line2D:
    kind = "engine" if is_engine(name) else "exact"
    return Line2D([], [], label=f"{name} ({kind})", **style(name).of_line())
