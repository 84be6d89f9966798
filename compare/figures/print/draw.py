"""A figure for a paper, drawn from comparisons: one panel per variant and receiver."""

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from cases.errors import SceneError
from compare.figures import fonts
from compare.figures.print.appearance import MM, Appearance
from compare.figures.print.layout import Cell, add_axes, add_legend, arrange, cells, set_titles
from compare.figures.print.text import WORDS, Words
from compare.figures.style import in_order
from compare.figures.subplots import UNITS, Panel, panels
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

MEASURED = 200  # dots per inch for measuring text


def draw(
    comparisons: list[Comparison], appearance: Appearance, columns: int, language: str
) -> Figure:
    """Return the figure.

    columns : 1 or 2, of the page. language : "en" or "zh".
    Raises SceneError if it would be taller than a page, or if no installed font has its letters.
    """
    words, families = WORDS[language], families_of(language)
    every = [panel for row in panels(comparisons) for panel in row]
    titles = [f"({_letter(i)}) {words.title(panel)}" for i, panel in enumerate(every)]
    titles = titles if len(every) > 1 else [words.title(every[0])]
    by_variant = [
        [title for title, panel in zip(titles, every, strict=True) if panel.comparison is one]
        for one in comparisons
    ]
    _refuse_unknown_letters(titles, families)
    _refuse_unknown_letters([b.curves.name for b in comparisons[0].besides], families)
    with matplotlib.rc_context(appearance.rc(families)):
        figure = Figure(
            (appearance.widths[columns - 1] * MM, appearance.tallest * MM), dpi=MEASURED
        )
        FigureCanvasAgg(figure)
        legend = add_legend(figure, _entries(comparisons, appearance, words), appearance)
        places = cells(by_variant, appearance, columns, legend)
        if not places:
            raise _too_many(len(every), appearance, comparisons[0])
        axes = add_axes(figure, places)
        units = _units(every)
        for ax, panel in zip(axes, every, strict=True):
            _draw_panel(ax, panel, appearance, units[panel.quantity])
            ax.set_ylabel(words.axis(panel, units[panel.quantity].name))
        _label_times(axes, places, comparisons, words)
        arrange(figure, appearance, axes, places, legend)  # for their width
        set_titles(axes, titles)
        arrange(figure, appearance, axes, places, legend)
    return figure


def _letter(i: int) -> str:
    """Return a, b, ..., z, aa, ab, ..."""
    return (_letter(i // 26 - 1) if i >= 26 else "") + chr(97 + i % 26)


def _units(found: list[Panel]) -> dict[str, Unit]:
    """Return a suitable unit of every quantity, from its largest value."""
    peaks: dict[str, float] = {}
    for panel in found:
        for curve in [*panel.curves.values(), *panel.given.values()]:
            peak = float(np.abs(curve.values).max(initial=0.0))
            peaks[panel.quantity] = max(peak, peaks.get(panel.quantity, 0.0))
    return {quantity: unit_for(UNITS[quantity], 1.001 * peak) for quantity, peak in peaks.items()}


def families_of(language: str) -> list[str]:
    """Return the font families; raises SceneError if there is none for a language."""
    found = fonts.families()
    if len(found) == 1 and language == "zh":
        allowed = f"needs a font with Chinese characters: {fonts.HINT}"
        raise SceneError("--language", "zh", None, allowed)
    return found


def _draw_panel(ax: Axes, panel: Panel, appearance: Appearance, unit: Unit) -> None:
    ax.axhline(0, color="#999999", linewidth=0.4, zorder=1)
    for name, curve in panel.curves.items():
        ax.plot(1e3 * curve.index, curve.values / unit.size, **appearance.of_line(name))
    for k, beside in enumerate(panel.comparison.besides):
        curve = panel.given.get(beside.curves.name)
        if curve is not None:
            ax.plot(1e3 * curve.index, curve.values / unit.size, **appearance.of_given(k))
    ax.margins(x=0)
    ax.yaxis.set_major_locator(MaxNLocator(4))  # independent of the panel's height


def _label_times(
    axes: list[Axes], places: list[Cell], comparisons: list[Comparison], words: Words
) -> None:
    """Label times below all panels or, if equal, below the lowest of each column."""
    alike = len({comparison.scene.time.duration for comparison in comparisons}) == 1
    for ax, (row, column) in zip(axes, places, strict=True):
        if alike and (row + 1, column) in places:
            ax.tick_params(labelbottom=False)
        else:
            ax.set_xlabel(words.time)


def _entries(found: list[Comparison], appearance: Appearance, words: Words) -> list[Line2D]:
    """Return the legend's entries: solutions in their order, then external files."""
    names = in_order({name for comparison in found for name in comparison.results})
    entries = [Line2D([], [], label=words.solution(n), **appearance.of_line(n)) for n in names]
    given = enumerate(found[0].besides)
    return entries + [
        Line2D([], [], label=beside.curves.name, **appearance.of_given(k)) for k, beside in given
    ]


def _too_many(count: int, appearance: Appearance, first: Comparison) -> SceneError:
    allowed = (
        f"{count} panels do not fit {appearance.tallest:g} mm: choose --columns 2, a --variant, or "
        "fewer places by --set record.stress=..."
    )
    return SceneError(first.scene.where, "", None, allowed)


def _refuse_unknown_letters(given: list[str], families: list[str]) -> None:
    """Raise SceneError if no font has a letter of the users' names."""
    text = "".join(given)
    for file in (fonts.file_of(family) for family in families):
        text = "".join(fonts.missing(file, text))
    if text:
        letters = " ".join(sorted(text)[:8])
        raise SceneError("figure", "", None, f"no font here has {letters}; {fonts.HINT}")
