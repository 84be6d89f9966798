"""The appearance of a figure for a paper: widths, fonts, lines.

The widths are those of Elsevier's artwork (International Journal of Rock Mechanics and Mining
Sciences and others): 90 mm for one column, 190 mm for two, at most 240 mm high.
"""

from typing import Any, NamedTuple

from compare.engines import names, solver
from compare.figures.style import GIVEN, RC, style

MM = 1 / 25.4  # inches
POINT = 25.4 / 72  # mm


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
