"""Appearance and layout of a figure for a paper: widths, fonts, lines; panels, titles, legend.

The widths are those of Elsevier's artwork (International Journal of Rock Mechanics and Mining
Sciences and others): 90 mm for one column, 190 mm for two, at most 240 mm high.
"""

import re
from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

from compare.engines import names, solver
from compare.figures.style import GIVEN, RC, style

MM = 1 / 25.4  # inches
POINT = 25.4 / 72  # mm

SPACELESS = "\u2e80-\u9fff\uac00-\ud7a3\uf900-\ufaff\uff00-\uffef"  # scripts without spaces
#: Unbreakable unit: a word, or a letter of such a script, with the space or bracket before it and
#: the punctuation after it. A no-break space does not separate.
PIECE = re.compile(f"[ \t\n]*[（《「]*(?:[{SPACELESS}]|[^ \t\n{SPACELESS}]+)[，。、；：）》」]*")
LETTER, LINE = 0.62, 1.25  # width of a letter on average, and height of a line, over its size
FREE = 2  # additional lines of a title that fit in the space of the times
HANDLE, APART = 0.5, 1.2  # in a legend, letters from a line to its text, and between columns
BESIDE = 14.0  # mm beside a panel, for its ordinate
TICK = 10.0  # least mm per number along the time axis

Cell = tuple[int, int]


class Appearance(NamedTuple):
    """widths : mm, of one and of two columns. most : largest number of panels side by side in each.
    tallest : mm. panel, least : mm, preferred and smallest height of a panel. text, small :
    points, of titles and labels, and of ticks and legend. handle : length of a line in the legend,
    in letters. prints : whether dashes distinguish curves without colour. dpi : of a PNG."""

    widths: tuple[float, float]
    most: tuple[int, int]
    tallest: float
    panel: float
    least: float
    text: float
    small: float
    handle: float
    prints: bool
    dpi: int

    def rc(self, families: list[str]) -> dict[Any, Any]:
        """Return matplotlib's settings; families : of the fonts, in order of preference."""
        return RC | {
            "font.family": families,
            "font.size": self.text,
            "axes.titlesize": self.text,
            "axes.labelsize": self.text,
            "xtick.labelsize": self.small,
            "ytick.labelsize": self.small,
            "legend.fontsize": self.small,
            "axes.linewidth": 0.5,
            "xtick.major.width": 0.5,
            "ytick.major.width": 0.5,
            "xtick.major.size": 2.5,
            "ytick.major.size": 2.5,
            "text.hinting": "none",  # letters as wide in print as they are measured
            "pdf.fonttype": 42,  # TrueType, not outlines of single letters
            "svg.fonttype": "none",  # letters stay letters; the font is put into the file
        }

    def of_line(self, name: str) -> dict[str, Any]:
        """Return the line style of a solution, as arguments of matplotlib's plot."""
        line = style(name).of_line()
        if self.prints and name in names():
            own = solver(name).line
            dashes = (0, own.printed) if own.printed else "-"
            line |= {"linewidth": own.printed_width, "linestyle": dashes}
        return line

    def of_given(self, k: int) -> dict[str, Any]:
        """Return the line style of the k-th external file."""
        return GIVEN[k % len(GIVEN)].of_line()


STYLES = {
    "journal": Appearance((90.0, 190.0), (2, 4), 240.0, 42.0, 26.0, 8.0, 7.5, 2.8, True, 600),
    "screen": Appearance((160.0, 280.0), (2, 4), 900.0, 58.0, 40.0, 10.0, 9.0, 4.5, False, 160),
}


def cells(
    titles: Sequence[Sequence[str]], appearance: Appearance, columns: int, legend: float
) -> list[Cell]:
    """Return the row and column of every panel, those of a variant one after the other.

    titles : of the panels of each variant. columns : of the page. legend : mm above the panels. As
    few panels are side by side as the page's height allows. Each variant begins a row if it fills
    one and all of them fit. Empty if they do not fit.
    """
    counts = [len(group) for group in titles]
    longest = max((title for group in titles for title in group), key=_letters)
    for across in range(min(columns, sum(counts)), appearance.most[columns - 1] + 1):
        letters = (appearance.widths[columns - 1] / across - BESIDE) / (
            LETTER * appearance.text * POINT
        )
        more = max(0, int(_letters(longest) / letters) - FREE)
        height = appearance.least + more * LINE * appearance.text * POINT
        for groups in (counts, [sum(counts)]) if min(counts) >= across else ([sum(counts)],):
            if sum(-(-count // across) for count in groups) * height <= appearance.tallest - legend:
                return _filled(groups, across)
    return []


def _letters(text: str) -> int:
    """Return the length of a text; letters of scripts without spaces count twice."""
    return len(text) + len(re.findall(f"[{SPACELESS}]", text))


def _filled(groups: Sequence[int], across: int) -> list[Cell]:
    found: list[Cell] = []
    for count in groups:
        row = found[-1][0] + 1 if found else 0
        found += [(row + i // across, i % across) for i in range(count)]
    return found


def add_axes(figure: Figure, places: list[Cell]) -> list[Axes]:
    """Add axes at the given cells only."""
    rows, across = (max(place) + 1 for place in zip(*places, strict=True))
    grid = figure.subplots(rows, across, squeeze=False)
    for cell in {(i, j) for i in range(rows) for j in range(across)} - set(places):
        grid[cell].remove()
    return [grid[cell] for cell in places]


def set_titles(axes: list[Axes], titles: list[str]) -> None:
    """Set titles above panels, in as many lines as needed, and as many times as fit below."""
    for ax, title in zip(axes, titles, strict=True):
        width = ax.get_window_extent().width
        drawn = ax.set_title("", pad=3)
        drawn.set_text(_in_lines(title, drawn, width))
        count = int(width / ax.figure.dpi / MM / TICK)
        ax.xaxis.set_major_locator(MaxNLocator(max(1, min(count, 8)), steps=[1, 2, 2.5, 5, 10]))


def add_legend(figure: Figure, entries: list[Line2D], appearance: Appearance) -> float:
    """Add the legend above the panels, with as many columns as fit; return its height, mm."""
    letter = appearance.small / 72 * figure.dpi  # pixels
    width, beside = 0.98 * figure.bbox.width, (appearance.handle + HANDLE) * letter
    measure, widths = figure.text(0, 0, "", fontsize=appearance.small), []
    for entry in entries:
        entry.set_label(_in_lines(str(entry.get_label()), measure, width - beside - letter))
        measure.set_text(entry.get_label())
        widths.append(measure.get_window_extent().width + beside)
    measure.remove()
    legend = figure.legend(
        handles=entries,
        ncols=_columns(widths, APART * letter, width - letter),
        loc="upper center",
        bbox_to_anchor=(0.5, 1.0),
        frameon=False,
        handlelength=appearance.handle,
        handletextpad=HANDLE,
        columnspacing=APART,
        labelspacing=0.3,
        borderpad=0.1,
        borderaxespad=0.2,
    )
    return _highest(figure, legend)


def _highest(figure: Figure, legend: Legend) -> float:
    """Return a legend's height, mm: at 72 dots per inch, as in a PDF, rows may be rounded up."""
    measured, found = figure.dpi, []
    for dpi in (72.0, measured):
        figure.dpi = dpi
        found.append(legend.get_window_extent().height / dpi / MM)
    return max(found)


def _columns(widths: list[float], apart: float, room: float) -> int:
    """Return the number of columns, `apart` from each other, in which entries fit."""

    def width(count: int) -> float:
        return sum(column.max() + apart for column in np.array_split(widths, count)) - apart

    return next((n for n in range(len(widths), 1, -1) if width(n) <= room), 1)


def arrange(
    figure: Figure, appearance: Appearance, axes: list[Axes], places: list[Cell], legend: float
) -> None:
    """Set the figure's height and place the panels below the legend (height in mm)."""
    rows = 1 + max(row for row, _ in places)
    lines = [ax.get_title(loc="left").count("\n") for ax in axes]
    by_row = groupby(zip(places, lines, strict=True), key=lambda one: one[0][0])
    extra = sum(max(n for _, n in row) for _, row in by_row) * LINE * appearance.text * POINT
    legend += appearance.small * POINT / 2
    panels = min(rows * appearance.panel + extra, appearance.tallest - legend)
    figure.set_figheight((panels + legend) * MM)
    top = panels / (panels + legend)
    figure.tight_layout(rect=(0, 0, 1, top), pad=0.3, h_pad=0.6, w_pad=0.8)


def _in_lines(text: str, drawn: Text, width: float) -> str:
    """Return a text in lines of at most `width` pixels in the font of `drawn`; dollar signs are
    literal."""

    def fits(line: str) -> bool:
        drawn.set_text(_plain(line))
        return float(drawn.get_window_extent().width) <= width

    return _plain("\n".join(wrapped(text, fits)))


def _plain(text: str) -> str:
    return text.replace("$", r"\$")


def wrapped(text: str, fits: Callable[[str], bool]) -> list[str]:
    """Return lines that fit, broken at spaces or beside a Chinese letter, within a word only if it
    is longer than a line."""
    lines = [""]
    for piece in PIECE.findall(text):
        if fits((lines[-1] + piece).lstrip()):
            lines[-1] = (lines[-1] + piece).lstrip()
            continue
        lines.append("")
        for letter in piece.lstrip():
            if lines[-1] and not fits(lines[-1] + letter):
                lines.append("")
            lines[-1] += letter
    return [line for line in lines if line]
