"""A chart as data: curves in subplots over one abscissa, for print and for the screen alike."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from compare.engines import ENGINES
from compare.figures.style import Style, families, given_style, in_order, style
from compare.misfit.pairs import Comparison

LONGEST = 28  # letters of a file's name in a legend


class ChartLine(NamedTuple):
    """A curve in the units of its axes.

    name : its entry in the legend. hover : hover text of plotly.js. part : name of its group in the
    SVG, after the figure's own name. hovered : values of `hover`, if not `y`.
    """

    name: str
    style: Style
    x: np.ndarray
    y: np.ndarray
    hover: str
    part: str = ""
    marker: str = ""
    hovered: np.ndarray | None = None


class Mark(NamedTuple):
    """A vertical line at x with its name, to its left or right, at the top or the bottom."""

    x: float
    name: str
    is_left: bool
    is_high: bool


class Subplot(NamedTuple):
    """One pair of axes.

    height : inches in print. share : subplots with the same name share an ordinate. limits, ticks :
    of the ordinate. levels : of thin horizontal lines. is_minor : small, as for residuals.
    """

    heading: str
    label: str
    lines: list[ChartLine]
    height: float = 2.1
    share: str = ""
    is_log: bool = False
    limits: tuple[float, float] | None = None
    ticks: list[float] | None = None
    levels: tuple[float, ...] = ()
    marks: tuple[Mark, ...] = ()
    is_minor: bool = False


class Entry(NamedTuple):
    """A legend entry: the name of its lines, its label in print, and its style."""

    name: str
    label: str
    style: Style
    marker: str = ""


class Chart(NamedTuple):
    """Rows of cells, each with the same number of subplots one below the other.

    legend : entries by heading; those without a heading form one line. is_log : of the
    abscissa. is_lettered : whether print numbers the cells (a), (b), ...
    """

    grid: list[list[list[Subplot]]]
    abscissa: str
    legend: dict[str, list[Entry]]
    is_log: bool = False
    is_lettered: bool = False

    @property
    def subplots(self) -> list[Subplot]:
        """All subplots, in the order of the page."""
        return [subplot for row in self.grid for cell in row for subplot in cell]


def solutions_legend(comparisons: list[Comparison], given: bool = True) -> dict[str, list[Entry]]:
    """Return the entries of all results, those of a model under its name, and of external data."""
    names = {name for comparison in comparisons for name in comparison.results}
    known = {name for family in families().values() for name in family}
    legend = {
        heading: _entries(n for n in family if n in names) for heading, family in families().items()
    }
    legend["Other"] = _entries(in_order(names - known))
    if given:
        legend["Given"] = _given(comparisons)
    return {heading: entries for heading, entries in legend.items() if entries}


def _entries(names: Iterable[str]) -> list[Entry]:
    return [Entry(n, f"{n} ({'engine' if n in ENGINES else 'exact'})", style(n)) for n in names]


def _given(comparisons: list[Comparison]) -> list[Entry]:
    found: dict[str, Entry] = {}
    for comparison in comparisons:
        for k, beside in enumerate(comparison.besides):
            name = beside.curves.name
            found.setdefault(name, Entry(name, short(name), *given_style(k, len(beside.time))))
    return list(found.values())


def short(file: str) -> str:
    """Return a file's name for a legend, shortened, with dollar signs escaped."""
    name = file if len(file) <= LONGEST else f"{file[:12]}…{file[-15:]}"
    return name.replace("$", r"\$")
