"""A figure for a paper, drawn from comparisons: one panel a variant and receiver."""

from __future__ import annotations

from textwrap import wrap

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cases.errors import SceneError
from compare import fonts
from compare.figures import UNITS
from compare.pairs import Comparison
from compare.panels import Panel, panels
from compare.papers.look import MM, Look
from compare.papers.words import WORDS, Words
from compare.style import in_order

LATIN = "DejaVu Sans"  # comes with matplotlib
POINT = 25.4 / 72  # mm
MOST_ACROSS = 2  # panels beside each other, in two columns


def draw(comparisons: list[Comparison], look: Look, columns: int, language: str) -> Figure:
    """Return the figure.

    columns : 1 or 2, of the page. language : "en" or "zh".
    Raises SceneError where it would be taller than a page, and where no font here has its letters.
    """
    words, families = WORDS[language], _families(language)
    grid = panels(comparisons)
    found = [panel for row in grid for panel in row]
    _refuse_unknown_letters([words.title(panel) for panel in found], families)
    _refuse_unknown_letters([b.curves.name for b in comparisons[0].besides], families)
    across = min(len(grid[0]), MOST_ACROSS) if columns == 2 else 1
    with matplotlib.rc_context(look.rc(families)):
        figure = Figure(figsize=(look.widths[columns - 1] * MM, 1.0))
        FigureCanvasAgg(figure)
        rows = -(-len(found) // across)
        axes = figure.subplots(rows, across, squeeze=False).ravel()
        for i, (ax, panel) in enumerate(zip(axes, found, strict=False)):
            letter = f"({chr(97 + i)}) " if len(found) > 1 else ""
            _draw_panel(ax, panel, look, words)
            _set_title(ax, letter + words.title(panel), look, look.widths[columns - 1] / across)
            ax.set_xlabel(words.time)
        for ax in axes[len(found) :]:
            ax.set_visible(False)
        legend = _add_legend(figure, comparisons, look, words)
        _arrange(figure, look, rows, legend, comparisons[0])
    return figure


def _families(language: str) -> list[str]:
    """Return the fonts' families: Latin letters, then Chinese ones where they are installed."""
    chinese = fonts.chinese_font()
    if chinese is None and language == "zh":
        allowed = f"needs a font with Chinese characters: {fonts.HINT}"
        raise SceneError("--language", "zh", None, allowed)
    return [LATIN] if chinese is None else [LATIN, chinese.name]


def _draw_panel(ax: Axes, panel: Panel, look: Look, words: Words) -> None:
    factor, unit = UNITS[panel.quantity]
    ax.axhline(0, color="#999999", linewidth=0.4, zorder=1)
    for name, curve in panel.curves.items():
        ax.plot(1e3 * curve.index, factor * curve.values, **look.of_line(name))
    for k, beside in enumerate(panel.comparison.besides):
        curve = panel.given.get(beside.curves.name)
        if curve is not None:
            ax.plot(1e3 * curve.index, factor * curve.values, **look.of_given(k))
    ax.margins(x=0)
    ax.set_ylabel(words.axis(panel, unit))


def _set_title(ax: Axes, title: str, look: Look, width: float) -> None:
    """Put a title over a panel, in as many lines as it needs; width : mm."""
    letters = int(width / (0.6 * look.text * POINT))
    ax.set_title("\n".join(wrap(title.replace("$", r"\$"), letters)), pad=3)


def _add_legend(figure: Figure, found: list[Comparison], look: Look, words: Words) -> float:
    """Put the legend above the panels, as wide as fits; return its height, mm."""
    names = in_order({name for comparison in found for name in comparison.results})
    entries = [Line2D([], [], label=words.solution(n), **look.of_line(n)) for n in names]
    for k, beside in enumerate(found[0].besides):
        label = beside.curves.name.replace("$", r"\$")
        entries.append(Line2D([], [], label=label, **look.of_given(k)))
    for columns in range(len(entries), 0, -1):
        legend = figure.legend(
            handles=entries,
            ncols=columns,
            loc="upper center",
            bbox_to_anchor=(0.5, 1.0),
            frameon=False,
            handlelength=look.handle,
            handletextpad=0.5,
            columnspacing=1.2,
            labelspacing=0.3,
            borderpad=0.1,
            borderaxespad=0.2,
        )
        box = legend.get_window_extent().transformed(figure.dpi_scale_trans.inverted())
        if box.width <= figure.get_figwidth() or columns == 1:
            break
        legend.remove()
    return box.height / MM


def _arrange(figure: Figure, look: Look, rows: int, legend: float, first: Comparison) -> None:
    """Give the figure its height and the panels their places below the legend of so many mm."""
    legend += look.small * POINT / 2
    panel = min(look.panel, (look.tallest - legend) / rows)
    if panel < look.least:
        allowed = (
            f"{rows} rows of panels do not fit {look.tallest:g} mm: choose a --variant, or fewer "
            "places by --set record.stress=..."
        )
        raise SceneError(first.scene.where, "", None, allowed)
    height = rows * panel + legend
    figure.set_figheight(height * MM)
    figure.tight_layout(rect=(0, 0, 1, 1 - legend / height), pad=0.3, h_pad=0.6, w_pad=0.8)


def _refuse_unknown_letters(given: list[str], families: list[str]) -> None:
    """Raise SceneError where a letter of what users have named is in no font."""
    text = "".join(given)
    for file in (fonts.file_of(family) for family in families):
        text = "".join(fonts.missing(file, text))
    if text:
        letters = " ".join(sorted(text)[:8])
        raise SceneError("figure", "", None, f"no font here has {letters}; {fonts.HINT}")
