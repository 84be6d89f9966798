"""Empty figures, charts with a common abscissa, and the files of a figure: SVG, PDF, PNG, CSV."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from pandas import DataFrame

from jointwave.compare.figures.style import RC, SIZE
from jointwave.compare.runs.output import write, write_csv

DIGITS = 6  # of the numbers behind a figure
HEADING, ABSCISSA, LINE = 0.3, 0.45, 0.19  # inches of a heading, the abscissa, a line of legend
BESIDE = 0.8  # inches beside axes
LETTER, HANDLE = 0.6, 7.0  # width of a letter and of a legend's handle, over the font size
NARROW = 4.0  # height over width of axes, above which labels of the abscissa may overlap
SMALLER = 0.76  # factor of the height of axes in more than two rows


class ShownFigure(Figure):
    """A figure that a notebook shows at the end of a cell, like pyplot's."""

    def _repr_png_(self) -> bytes:
        self.savefig(found := io.BytesIO(), format="png")
        return found.getvalue()


@contextmanager
def blank(height: float, rc: dict[Any, Any] = RC) -> Iterator[Figure]:
    """Yield an empty figure, with the width of matplotlib's settings `rc`; height : inches."""
    with matplotlib.rc_context(rc):
        width = rcParams["figure.figsize"][0]
        figure = ShownFigure((width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


def label_ends(ax: Axes) -> None:
    """Label the abscissa of narrow axes with an aspect at its ends only, outwards."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    if float(ax.get_aspect()) * (high - low) > NARROW * (right - left):
        ticks = [x for x in ax.get_xticks() if left <= x <= right]
        ax.set_xticks([ticks[0], ticks[-1]])
        for label, side in zip(ax.get_xticklabels(), ("right", "left"), strict=True):
            label.set(horizontalalignment=side)


@contextmanager
def chart(
    rows: int, columns: int, heights: list[float], abscissa: str, rc: dict[Any, Any] = RC
) -> Iterator[tuple[Figure, np.ndarray]]:
    """Yield a figure and its axes [row, part, column] with a common abscissa.

    heights : of the parts of a row, from top to bottom, in inches for the page's font size. rc :
    matplotlib's settings. Empty axes are hidden, the abscissa is labelled below the lowest axes of
    each column, and the legend has every label once.
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
    """Set the heading of axes, wrapped to their width."""
    columns = ax.get_subplotspec().get_gridspec().ncols  # type: ignore[union-attr]
    width = rcParams["figure.figsize"][0] / columns - BESIDE
    size = rcParams["font.size"] * (5 / 6 if small else 1.0)
    letters = int(72 * width / (0.85 * LETTER * size))
    ax.set_title(fill(heading, letters), fontsize=size, parse_math=False)


class SceneFigure(NamedTuple):
    """A figure of a scene and its solutions.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. table : the drawn data, without index; headers give
    units. folded : whether it is in a collapsed section of the page.
    """

    name: str
    title: str
    caption: str
    figure: Figure
    table: DataFrame
    folded: bool = False


class Drawn(NamedTuple):
    """The files of a figure: NAME.svg, NAME.pdf and, if requested, NAME.png; its numbers NAME.csv.

    caption, folded : see `SceneFigure`.
    """

    name: str
    title: str
    folder: Path
    caption: str = ""
    folded: bool = False

    def file(self, kind: str) -> Path:
        """Return the figure's file of a kind such as "pdf"."""
        return self.folder / f"{self.name}.{kind}"

    @property
    def drawings(self) -> list[Path]:
        """The files of its drawings, PNG included."""
        return [self.file(kind) for kind in ("svg", "pdf", "png")]


def save(
    figure: Figure,
    folder: Path,
    name: str,
    title: str,
    table: DataFrame | None = None,
    png: bool = True,
) -> Drawn:
    """Write a figure's files; without a table the caller writes the CSV. png : also write PNG."""
    drawn = Drawn(name, title, folder)
    if table is not None:
        write_csv(drawn.file("csv"), table, DIGITS)
    with matplotlib.rc_context(RC):
        if (layout := figure.get_layout_engine()) is not None:
            layout.execute(figure)  # here, once: matplotlib would draw each format twice
        figure.set_layout_engine(None)
    for path in drawn.drawings[: 3 if png else 2]:
        write_drawing(path, figure, title)
    return drawn


def write_drawing(path: Path, figure: Figure, title: str = "", rc: dict[Any, Any] = RC) -> Path:
    """Write a figure in the format of the suffix, .svg, .pdf or .png. Equal figures give equal
    files. It is created in memory: matplotlib's writers fail in many ways on a full disk."""
    kind, content = path.suffix[1:], io.BytesIO()
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(kind, {})
    with matplotlib.rc_context(rc | {"svg.hashsalt": title}):
        figure.savefig(content, format=kind, metadata={"Title": title} | undated)
    return write(path, lambda place: place.write_bytes(content.getvalue()))
