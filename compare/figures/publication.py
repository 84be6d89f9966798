"""A figure for a paper, drawn from comparisons: one panel per variant and receiver.

The widths are those of Elsevier's artwork (International Journal of Rock Mechanics and Mining
Sciences and others): 90 mm for one column, 190 mm for two, at most 240 mm high.
"""

from textwrap import wrap
from typing import Any, NamedTuple
from unicodedata import east_asian_width

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import in_order, names, solver
from jointwave.compare.figures import fonts
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.panels import Panel, panels
from jointwave.compare.figures.style import GIVEN, RC, style
from jointwave.compare.figures.units import UNITS, Unit, unit_for
from jointwave.compare.figures.words import WORDS, Words
from jointwave.compare.misfit.pairs import Comparison

MM, POINT = 1 / 25.4, 25.4 / 72  # inches; mm
LETTER, LINE = 0.62, 1.3  # width of a letter on average, and height of a line, over its size
HANDLE, APART = 0.8, 1.6  # in a legend, letters from a line to its text, and between columns
BESIDE = 14.0  # mm beside a panel, for its ordinate
TICK = 10.0  # least mm per number along the time axis


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

    def rc(self, language: str) -> dict[Any, Any]:
        """Return matplotlib's settings; raises SceneError if there is no font for the language."""
        return RC | {
            "font.family": fonts.families_of(language),
            "font.size": self.text,
            "axes.titlesize": self.text,
            "axes.titlepad": 3,
            "axes.labelsize": self.text,
            "xtick.labelsize": self.small,
            "ytick.labelsize": self.small,
            "legend.fontsize": self.small,
            "legend.handlelength": self.handle,
            "legend.handletextpad": HANDLE,
            "legend.columnspacing": APART,
            "legend.labelspacing": 0.3,
            "axes.linewidth": 0.5,
            "xtick.major.width": 0.5,
            "ytick.major.width": 0.5,
            "xtick.major.size": 2.5,
            "ytick.major.size": 2.5,
        }

    def of_line(self, name: str) -> dict[str, Any]:
        """Return the line style of a solution, as arguments of matplotlib's plot."""
        line = style(name).of_line()
        if self.prints and name in names():
            own = solver(name).line
            dashes = (0, own.printed) if own.printed else "-"
            line |= {"linewidth": own.printed_width, "linestyle": dashes}
        return line

    def letters(self, width: float, size: float) -> int:
        """Return how many letters of a size (points) a width (mm) has room for."""
        return max(1, int(width / (LETTER * size * POINT)))


STYLES = {
    "journal": Appearance((90.0, 190.0), (2, 4), 240.0, 42.0, 20.0, 8.0, 7.5, 2.8, True, 600),
    "screen": Appearance((160.0, 280.0), (2, 4), 900.0, 58.0, 40.0, 10.0, 9.0, 4.5, False, 160),
}


def draw(
    comparisons: list[Comparison], appearance: Appearance, columns: int, language: str
) -> Figure:
    """Return the figure.

    columns : 1 or 2, of the page. language : "en" or "zh".
    Raises SceneError if it would be taller than a page, or if no installed font has its letters.
    """
    words, settings = WORDS[language], appearance.rc(language)
    every = [panel for row in panels(comparisons) for panel in row]
    titles = [words.title(panel) for panel in every]
    if len(every) > 1:
        titles = [f"({_letter(i)}) {title}" for i, title in enumerate(titles)]
    fonts.refuse_unknown_letters([*titles, *(b.curves.name for b in comparisons[0].besides)])
    width = appearance.widths[columns - 1]
    legend, across = _legend(comparisons, appearance, words, width)
    head = LINE * appearance.small * POINT * -(-len(legend) // across) + 2.0
    arranged = _arranged(titles, appearance, columns, head)
    if arranged is None:
        allowed = (
            f"{len(every)} panels do not fit {appearance.tallest:g} mm: choose --columns 2, a "
            "--variant, or fewer places by --set record.stress=..."
        )
        raise SceneError(comparisons[0].scene.where, "", None, allowed)
    side, height, lines = arranged
    alike = len({comparison.scene.time.duration for comparison in comparisons}) == 1
    with blank(height * MM, width * MM, rc=settings) as figure:
        axes = figure.subplots(-(-len(every) // side), side, squeeze=False, sharex=alike).ravel()
        units, ticks = _units(every), max(1, min(8, int((width / side - BESIDE) / TICK)))
        for ax, panel, title in zip(axes, every, lines, strict=False):
            unit = units[panel.quantity]
            ax.set_title("\n".join(title))
            ax.set_ylabel(f"{words.quantities[panel.quantity]} ({unit.name})")
            _draw_panel(ax, panel, appearance, unit)
            ax.xaxis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 2.5, 5, 10]))
        for i, ax in enumerate(axes):
            ax.set_visible(i < len(every))
            if not alike or i + side >= len(every):  # the lowest of a column
                ax.tick_params(labelbottom=True)
                ax.set_xlabel(words.time)
        figure.legend(handles=legend, ncols=across, loc="outside upper center", borderpad=0.1)
    return figure


def _letter(i: int) -> str:
    """Return a, b, ..., z, aa, ab, ..."""
    return (_letter(i // 26 - 1) if i >= 26 else "") + chr(97 + i % 26)


def _length(text: str) -> int:
    """Return the length of a text in letters; those of scripts without spaces count twice."""
    return sum(1 + (east_asian_width(letter) in "WF") for letter in text)


def _lines(text: str, letters: int) -> list[str]:
    """Return a text in lines of at most so many letters; dollar signs are literal."""
    whole = max(1, letters * len(text) // _length(text))
    return [line.replace("$", r"\$") for line in wrap(text, whole)]


def _arranged(
    titles: list[str], appearance: Appearance, columns: int, head: float
) -> tuple[int, float, list[list[str]]] | None:
    """Return how many panels stand side by side, as few as the page's height allows, the height of
    the figure in mm, and the lines of each title; None if they do not fit.

    columns : of the page. head : mm above the panels.
    """
    for side in range(min(columns, len(titles)), appearance.most[columns - 1] + 1):
        width = appearance.widths[columns - 1] / side - BESIDE
        lines = [_lines(title, appearance.letters(width, appearance.text)) for title in titles]
        rows = [lines[i : i + side] for i in range(0, len(lines), side)]
        more = sum(max(map(len, row)) - 1 for row in rows) * LINE * appearance.text * POINT
        least, best = (head + more + len(rows) * x for x in (appearance.least, appearance.panel))
        if least <= appearance.tallest:
            return side, min(best, appearance.tallest), lines
    return None


def _units(found: list[Panel]) -> dict[str, Unit]:
    """Return a suitable unit of every quantity, from its largest value."""
    peaks: dict[str, float] = {}
    for panel in found:
        for curve in [*panel.curves.values(), *panel.given.values()]:
            peak = float(np.abs(curve.values).max(initial=0.0))
            peaks[panel.quantity] = max(peak, peaks.get(panel.quantity, 0.0))
    return {quantity: unit_for(UNITS[quantity], 1.001 * peak) for quantity, peak in peaks.items()}


def _draw_panel(ax: Axes, panel: Panel, appearance: Appearance, unit: Unit) -> None:
    ax.axhline(0, color="#999999", linewidth=0.4, zorder=1)
    for name, curve in panel.curves.items():
        ax.plot(1e3 * curve.index, curve.values / unit.size, **appearance.of_line(name))
    for k, beside in enumerate(panel.comparison.besides):
        curve = panel.given.get(beside.curves.name)
        if curve is not None:
            drawn = GIVEN[k % len(GIVEN)].of_line()
            ax.plot(1e3 * curve.index, curve.values / unit.size, **drawn)
    ax.yaxis.set_major_locator(MaxNLocator(4))


def _legend(
    found: list[Comparison], appearance: Appearance, words: Words, width: float
) -> tuple[list[Line2D], int]:
    """Return the entries, solutions in their order and then external files, and the number of
    columns in which they fit a width, mm."""
    solutions = in_order(name for comparison in found for name in comparison.results)
    lines = [(words.solution(name), appearance.of_line(name)) for name in solutions]
    given = enumerate(found[0].besides)
    lines += [(beside.curves.name, GIVEN[k % len(GIVEN)].of_line()) for k, beside in given]
    beside = appearance.handle + HANDLE + APART
    room = width / (appearance.small * POINT) - 1  # in sizes of a letter
    longest = max(_length(label) for label, _ in lines)
    columns = int(room / (LETTER * longest + beside))
    letters = int((room / max(1, columns) - beside) / LETTER)
    entries = [Line2D([], [], label="\n".join(_lines(label, letters)), **x) for label, x in lines]
    return entries, min(max(1, columns), len(entries))
