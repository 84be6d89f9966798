"""What charts share: rows of axes over one abscissa, their headings, and a legend above them."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from textwrap import fill
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jointwave.compare.engines import ENGINES, by_model, in_order
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import WIDTH, Style, given_style, style
from jointwave.compare.misfit.pairs import Comparison

HEADING, ABSCISSA, LINE = 0.3, 0.45, 0.19  # inches above axes, below the lowest, and of a legend's
BESIDE = 0.8  # inches beside axes
LETTER = 0.5  # width of a letter on average, over its size
SMALLER = 0.76  # of the height of axes, for more than two rows
LONGEST = 28  # letters of a file's name in a legend
GREY = "#5d6670"  # of marks


class Legend(NamedTuple):
    """The entries of a legend, one column after the other."""

    entries: list[Line2D]
    columns: int


@contextmanager
def chart(
    legend: Legend, rows: int, columns: int, heights: list[float], abscissa: str
) -> Iterator[tuple[Figure, np.ndarray]]:
    """Yield a figure and its axes [row, part, column], all over one abscissa.

    heights : inches of the parts of a row, one below the other. Axes left empty are hidden, and the
    abscissa is labelled below the lowest of each column.
    """
    lines = -(-len(legend.entries) // legend.columns)
    factor = SMALLER if rows > 2 else 1.0
    heights = [heights[0] * factor, *heights[1:]]
    height = rows * sum(h + HEADING for h in heights) + ABSCISSA + LINE * lines
    with blank(height) as figure:
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
        figure.legend(
            handles=legend.entries,
            ncols=legend.columns,
            loc="outside upper center",
            handlelength=4.0,
            labelspacing=0.25,
        )


def share(axes: Iterable[Axes]) -> None:
    """Let axes share their ordinate."""
    first, *others = axes
    for ax in others:
        ax.sharey(first)


def set_heading(ax: Axes, heading: str, small: bool = False) -> None:
    """Set the heading of axes, in as many lines as their width needs."""
    size = 8.0 if small else 9.0
    columns = ax.get_subplotspec().get_gridspec().ncols  # type: ignore[union-attr]
    width = 72 * (WIDTH / columns - BESIDE)
    parts = (fill(part, int(width / (LETTER * size))) for part in heading.split("\n"))
    ax.set_title("\n".join(parts), fontsize=size, pad=3)


def entry(label: str, drawn: Style, marker: str = "") -> Line2D:
    """Return a legend's entry."""
    return Line2D([], [], label=label, **drawn.of_line(marker))


def solutions_legend(comparisons: list[Comparison], others: dict[str, list[Line2D]]) -> Legend:
    """Return the entries of all results, a column for each model under its name, and of others."""
    groups: dict[str, list[Line2D]] = {}
    models = {name: heading for heading, found in by_model().items() for name in found}
    for name in in_order(name for comparison in comparisons for name in comparison.results):
        label = f"{name} ({'engine' if name in ENGINES else 'exact'})"
        groups.setdefault(models.get(name, "Other"), []).append(entry(label, style(name)))
    groups |= {heading: entries for heading, entries in others.items() if entries}
    depth = max(map(len, groups.values()))
    found: list[Line2D] = []
    for heading, entries in groups.items():
        found += [_nothing(heading), *entries, *[_nothing("")] * (depth - len(entries))]
    return Legend(found, len(groups))


def _nothing(label: str) -> Line2D:
    return Line2D([], [], linestyle="none", label=label)


def given_entries(comparisons: list[Comparison]) -> dict[str, list[Line2D]]:
    """Return the entries of external files under their heading."""
    found: dict[str, Line2D] = {}
    for comparison in comparisons:
        for k, beside in enumerate(comparison.besides):
            name = beside.curves.name
            found.setdefault(name, entry(short(name), *given_style(k, len(beside.time))))
    return {"Given": list(found.values())}


def short(file: str) -> str:
    """Return a file's name for a legend, shortened, with dollar signs escaped."""
    name = file if len(file) <= LONGEST else f"{file[:12]}…{file[-15:]}"
    return name.replace("$", r"\$")
