"""A figure for a paper, drawn from comparisons: one panel per variant and receiver."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from cases.errors import SceneError
from compare.engines import in_order, names, solver
from compare.figures import fonts
from compare.figures.export import blank
from compare.figures.panels import Panel, panels
from compare.figures.print.layout import (
    MM,
    Appearance,
    Cell,
    add_axes,
    add_legend,
    arrange,
    cells,
    set_titles,
)
from compare.figures.units import UNITS, Unit, unit_for
from compare.misfit.pairs import Comparison

MEASURED = 200  # dots per inch for measuring text


class Words(NamedTuple):
    """The words of one language.

    solutions : the field of a solver's words with its label. quantities : by name. place : with
    {quantity} and {at}. static : with {value}, the static state not drawn. parts : of variants'
    names from jointwave; those of the user are not translated. comma : between place and variant.
    """

    solutions: str
    quantities: dict[str, str]
    place: str
    static: str
    time: str
    parts: dict[str, str]
    comma: str

    def solution(self, name: str) -> str:
        """Return the legend label of an engine or exact solution."""
        return getattr(solver(name).words, self.solutions) if name in names() else name

    def axis(self, panel: Panel, unit: str) -> str:
        """Return the label of a panel's ordinate."""
        return f"{self.quantities[panel.quantity]} ({unit})"

    @staticmethod
    def _at(panel: Panel) -> str:
        """Return a receiver's position: y in a pillar, x and y in a rock mass."""
        at = panel.place.at
        return f"y\u00a0=\u00a0{at[0]:g}" if len(at) == 1 else f"[{at[0]:g},\u00a0{at[1]:g}]"

    def title(self, panel: Panel) -> str:
        """Return the title of a panel."""
        quantity = " ".join([self.quantities[panel.quantity], panel.place.component]).strip()
        parts = [self.parts.get(part, part) for part in panel.variant.split(", ")]
        place = [self.place.format(quantity=quantity, at=self._at(panel))]
        if rest := panel.at_rest:
            unit = unit_for(UNITS[panel.quantity], abs(rest))
            place.append(self.static.format(value=f"{rest / unit.size:.4g}\u00a0{unit.name}"))
        return self.comma.join([*place, *parts])


ENGLISH = Words(
    solutions="english",
    quantities={
        "stress": "stress",
        "shear": "shear stress",
        "traction": "traction",
        "velocity": "velocity",
        "rotation": "rotation",
    },
    place="{quantity} at {at}\u00a0m",
    static="minus the static {value}",
    time="time (ms)",
    parts={},
    comma=", ",
)

CHINESE = Words(
    solutions="chinese",
    quantities={
        "stress": "应力",
        "shear": "剪应力",
        "traction": "节理面应力",
        "velocity": "速度",
        "rotation": "转角",
    },
    place="{quantity}，{at}\u00a0m",
    static="减去静态值 {value}",
    time="时间 (ms)",
    parts={
        "undamped": "无阻尼",
        "soft layer": "含软弱层",
        "no soft layer": "无软弱层",
        "no tension": "不抗拉",
        "tension": "抗拉",
        "base scene": "原场景",
        "free start": "起端自由",
        "quiet start": "起端吸收",
        "matched start": "起端匹配",
        "fixed start": "起端固定",
        "free": "自由端",
        "quiet": "吸收端",
        "matched": "匹配端",
        "fixed": "固定端",
    },
    comma="，",
)

WORDS = {"en": ENGLISH, "zh": CHINESE}


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
    size = appearance.tallest * MM, appearance.widths[columns - 1] * MM
    with blank(*size, True, appearance.rc(families), MEASURED) as figure:
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
    names = in_order(name for comparison in found for name in comparison.results)
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
