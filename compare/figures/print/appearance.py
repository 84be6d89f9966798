"""The appearance of a figure for a paper: its widths, its letters, its lines.

The widths are those of Elsevier's artwork (International Journal of Rock Mechanics and Mining
Sciences and others): 90 mm for one column, 190 mm for two, at most 240 mm high.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from compare.figures.style import GIVEN, RC, is_engine, style

MM = 1 / 25.4  # inches
POINT = 25.4 / 72  # mm


class Appearance(NamedTuple):
    """widths : mm, of one and of two columns. most : panels beside each other, at most, in each.
    tallest : mm. panel, least : mm, height of a panel as it should be and at least. text, small :
    points, of titles and labels, and of ticks and legend. handle : length of a line in the legend,
    in letters. prints : whether dashes tell curves apart without colour. dpi : of a PNG."""

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
        """Return matplotlib's settings; families : of the fonts, the first that has a letter."""
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
        """Return how a solution's curve is drawn, as arguments of matplotlib's plot."""
        line = style(name).of_line()
        if self.prints:
            wide = ENGINE_WIDTH.get(name, 1.2) if is_engine(name) else EXACT_WIDTH
            line |= {"linewidth": wide, "linestyle": DASHES.get(name, "-")}
        return line

    def of_given(self, k: int) -> dict[str, Any]:
        """Return how the curve of the k-th file of others is drawn."""
        return GIVEN[k % len(GIVEN)].of_line()


#: On paper, points: engines wide and light, exact solutions thin and dark over them.
ENGINE_WIDTH = {"dem": 1.5, "continuum-jointed": 2.2, "continuum-equivalent": 2.9}
EXACT_WIDTH = 0.8

#: On paper, in line widths: no two alike, so that a grey copy still tells them apart.
DASHES: dict[str, Any] = {
    "dem": "-",
    "continuum-jointed": (0, (3.5, 0.9)),
    "continuum-equivalent": (0, (1.1, 0.8)),
    "lattice": (0, (1.2, 2.2)),
    "no-tension-chain": (0, (1.2, 1.2)),
    "spatial-lattice": (0, (1.2, 4)),
    "jointed-bar": (0, (6, 2.4)),
    "one-joint": (0, (3, 3)),
    "equivalent-bar": (0, (7, 2, 1.2, 2)),
    "images": (0, (7, 2, 1.2, 2, 1.2, 2)),
    "kelvin-voigt": (0, (4, 2, 1.2, 2, 1.2, 2)),
    "series": (0, (12, 3)),
    "slip-joint": (0, (6, 2.4, 3, 2.4)),
    "sliding-block": (0, (9, 2.4, 3, 2.4)),
}

STYLES = {
    "journal": Appearance((90.0, 190.0), (2, 4), 240.0, 42.0, 26.0, 8.0, 7.5, 2.8, True, 600),
    "screen": Appearance((160.0, 280.0), (2, 4), 900.0, 58.0, 40.0, 10.0, 9.0, 4.5, False, 160),
}
