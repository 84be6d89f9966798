"""A chart as a figure of matplotlib, for print."""

from string import ascii_lowercase

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from compare.figures.charts.chart import Chart, Entry, Mark, Subplot
from compare.figures.export import blank
from compare.figures.style import WIDTH, Style

HEADING, ABSCISSA = 0.28, 0.48  # inches above each subplot, and below the lowest
LEFT, RIGHT, BETWEEN = 0.95, 0.15, 0.9  # inches beside the subplots, and between two of them,
NUMBERS = 0.55  # the same if a shared ordinate is labelled only once
MOST = 6  # entries per line of a legend
LEGEND, LEGEND_LINE = 0.16, 0.165  # inches of the legend, plus each of its lines
SMALLER = 0.76  # of the height of a subplot, for more than two rows of cells
LETTER = 0.55  # width of a letter on average, over its size
MARK = "#5d6670"  # colour of vertical lines


def draw(name: str, chart: Chart) -> Figure:
    """Return the figure; the SVG group of a line is `name`-PART."""
    columns, heights = max(map(len, chart.grid)), _heights(chart)
    head = LEGEND + LEGEND_LINE * _depth(chart.legend)
    with blank(head + sum(h + HEADING for h in heights) + ABSCISSA, laid_out=True) as figure:
        alone = any(not cell[0].share for row in chart.grid for cell in row)
        axes = _axes(figure, columns, heights, BETWEEN if alone else NUMBERS)
        letters = iter(ascii_lowercase)
        depth, shared = len(chart.grid[0][0]), dict[str, Axes]()
        for i, row in enumerate(chart.grid):
            for j, cell in enumerate(row):
                for ax, subplot in zip(axes[depth * i :, j], cell, strict=False):
                    if subplot.share:
                        ax.sharey(shared.setdefault(subplot.share, ax))
                    _draw(ax, subplot, name, chart.is_log)
                    if j == 0 or not subplot.share:
                        ax.set_ylabel(subplot.label)
                if chart.is_lettered and (letter := next(letters, "")):
                    _set_title(axes[depth * i, j], f"({letter})  {cell[0].heading}")
            for ax in axes[depth * i : depth * (i + 1), len(row) :].ravel():
                ax.set_visible(False)
        for ax in (next(ax for ax in column[::-1] if ax.get_visible()) for column in axes.T):
            ax.tick_params(labelbottom=True)
            ax.set_xlabel(chart.abscissa)
        _add_legend(figure, chart.legend)
    return figure


def _axes(figure: Figure, columns: int, heights: list[float], between: float) -> np.ndarray:
    """Return rows of axes with these heights and distances (inches), at the bottom of a figure.

    All sizes are in inches: measuring text, as matplotlib's layouts do, takes a third of the time.
    """
    height, rows = figure.get_figheight(), len(heights)
    room = {
        "left": LEFT / WIDTH,
        "right": 1 - RIGHT / WIDTH,
        "bottom": ABSCISSA / height,
        "top": (ABSCISSA + sum(heights) + HEADING * (rows - 1)) / height,
        "hspace": HEADING / float(np.mean(heights)),
        "wspace": between * columns / (WIDTH - LEFT - RIGHT - between * (columns - 1)),
        "height_ratios": heights,
    }
    return figure.subplots(rows, columns, squeeze=False, sharex=True, gridspec_kw=room)


def _depth(legend: dict[str, list[Entry]]) -> int:
    """Return the number of lines of a legend: those of its entries and of headings above them."""
    return -(-len(legend[""]) // MOST) if "" in legend else 1 + max(map(len, legend.values()))


def _heights(chart: Chart) -> list[float]:
    factor = SMALLER if len(chart.grid) > 2 else 1.0
    return [
        subplot.height * (1.0 if subplot.is_minor else factor)
        for row in chart.grid
        for subplot in max(row, key=lambda cell: sum(s.height for s in cell))
    ]


def _set_title(ax: Axes, heading: str) -> None:
    """Set a title, in smaller letters if it is longer than the axes are wide."""
    points = 72 * ax.get_position().width * WIDTH
    size = min(ax.title.get_fontsize(), points / (LETTER * max(1, len(heading))))
    ax.set_title(heading, pad=4, fontsize=size)


def _draw(ax: Axes, subplot: Subplot, name: str, is_log: bool) -> None:
    if subplot.is_minor:
        ax.set_title(subplot.heading, pad=2, fontsize=8)
    else:
        _set_title(ax, subplot.heading)
    if is_log:
        ax.set_xscale("log")
    if subplot.is_log:
        ax.set_yscale("log")
        ax.yaxis.set_minor_locator(NullLocator())  # they would take longer than the curves
    elif subplot.ticks is not None:
        ax.set_yticks(subplot.ticks)
    elif subplot.is_minor:
        ax.locator_params(axis="y", nbins=4)
    if subplot.limits:
        ax.set_ylim(*subplot.limits)
    for level in subplot.levels:
        ax.axhline(level, color="#bbbbbb", linewidth=0.6, zorder=1)
    for line in subplot.lines:
        (drawn,) = ax.plot(line.x, line.y, **line.style.of_line(line.marker))
        drawn.set_gid(line.part or None)
    for mark in subplot.marks:
        _add_mark(ax, mark)
    ax.margins(x=0)


def _add_mark(ax: Axes, mark: Mark) -> None:
    ax.axvline(mark.x, color=MARK, linewidth=0.8, linestyle=":", zorder=1)
    ax.annotate(
        mark.name,
        (mark.x, 0.97 if mark.is_high else 0.03),
        (-2 if mark.is_left else 2, 0),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        rotation=90,
        ha="right" if mark.is_left else "left",
        va="top" if mark.is_high else "bottom",
        fontsize=7,
        color=MARK,
    )


def _add_legend(figure: Figure, legend: dict[str, list[Entry]]) -> None:
    """Add the legend above the subplots, where it hides no curve: one column per heading."""
    depth = _depth(legend)
    if "" in legend:
        handles, columns = _handles(legend[""]), -(-len(legend[""]) // depth)
    else:
        empty = Entry("", "", Style("none", 0.0, "-", 0))
        filled = [
            [empty._replace(label=heading), *entries, *[empty] * (depth - 1 - len(entries))]
            for heading, entries in legend.items()
        ]
        handles, columns = _handles([entry for column in filled for entry in column]), len(legend)
    found = figure.legend(
        handles=handles,
        ncols=columns,
        loc="upper center",
        bbox_to_anchor=(0.5, 1.0),
        frameon=False,
        handlelength=3.5 if "" in legend else 4.5,
        columnspacing=2.0 if "" in legend else 4.0,
        labelspacing=0.25,
    )
    for text in found.get_texts():
        if text.get_text() in legend:
            text.set_color(MARK)  # embedding a bold font would double the time of the plain one


def _handles(entries: list[Entry]) -> list[Line2D]:
    return [Line2D([], [], label=e.label, **e.style.of_line(e.marker)) for e in entries]
