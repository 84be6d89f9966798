"""Common layout of charts: rows of axes over one abscissa, their headings, a legend above."""

from collections.abc import Iterator
from contextlib import contextmanager
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import RC, SIZE

HEADING, ABSCISSA, LINE = 0.3, 0.45, 0.19  # inches above axes, below the lowest, and of a legend's
BESIDE = 0.8  # inches beside axes
LETTER, HANDLE = 0.6, 7.0  # over the size of letters: their width, and that of a legend's line
SMALLER = 0.76  # of the height of axes, for more than two rows


@contextmanager
def chart(
    rows: int, columns: int, heights: list[float], abscissa: str, rc: dict[Any, Any] = RC
) -> Iterator[tuple[Figure, np.ndarray]]:
    """Yield a figure and its axes [row, part, column], all over one abscissa.

    heights : of the parts of a row, one below the other: inches where letters have the page's size.
    rc : matplotlib's settings. Axes left empty are hidden, the abscissa is labelled below the
    lowest of each column, and the legend has every label once.
    """
    heights = [heights[0] * (SMALLER if rows > 2 else 1.0), *heights[1:]]
    with blank(1.0, rc=rc) as figure:
        ratios = {"height_ratios": heights * rows}
        axes = figure.subplots(
            rows * len(heights), columns, squeeze=False, sharex=True, gridspec_kw=ratios
        )
        yield figure, axes.reshape(rows, len(heights), columns)
        for ax in axes.flat:
            ax.set_visible(ax.has_data())
        for column in axes.T:
            lowest = next(ax for ax in column[::-1] if ax.get_visible())
            lowest.tick_params(labelbottom=True)
            lowest.set_xlabel(abscissa)
        lines = _add_legend(figure)
        height = rows * sum(h + HEADING for h in heights) + ABSCISSA + LINE * lines
        figure.set_figheight(height * rcParams["font.size"] / SIZE)


def _add_legend(figure: Figure) -> int:
    """Add a legend of all lines above the axes, within the figure; return its number of lines."""
    entries: dict[str, Any] = {}
    for ax in figure.axes:
        for line, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, line)
    room = 72 * figure.get_figwidth() / rcParams["font.size"]
    labels = [fill(label, int((room - HANDLE) / LETTER)) for label in entries]
    columns = int(np.clip(room // (HANDLE + LETTER * max(map(len, entries))), 1, len(entries)))
    place: dict[str, Any] = {"loc": "outside upper center", "ncols": columns, "handlelength": 4.0}
    legend = figure.legend(list(entries.values()), labels, **place)
    for text in legend.get_texts():
        text.set_parse_math(False)  # users' names may have dollar signs
    return -(-len(entries) // columns) + sum(label.count("\n") for label in labels)


def set_heading(ax: Axes, heading: str, small: bool = False) -> None:
    """Set the heading of axes, in as many lines as their width needs."""
    columns = ax.get_subplotspec().get_gridspec().ncols  # type: ignore[union-attr]
    width = rcParams["figure.figsize"][0] / columns - BESIDE
    size = rcParams["font.size"] * (5 / 6 if small else 1.0)
    letters = int(72 * width / (0.85 * LETTER * size))
    ax.set_title(fill(heading, letters), fontsize=size, parse_math=False)
