"""Styles of figures: one hue per model, one pattern per kind of solution.

Engines are wide, light and solid, nested by width so that none hides another where they coincide;
exact solutions are thin, dark and dashed over them. Hues are those of Okabe & Ito (2008), safe for
all kinds of colour blindness.
"""

from typing import Any, NamedTuple

from matplotlib import rcParams

from jointwave.compare.engines import names, solver

WIDTH = 11.0  # inches of the page's figures, which it shows at the width of its column
SIZE, LINE = 9.0, 1.5  # points, of the page's letters, and of lines whose style has width 1.5


class Style(NamedTuple):
    """A curve: colour, width in points, dash pattern, its order, the last drawn on top, and the
    marker of its samples, if any."""

    colour: str
    width: float
    dashes: Any
    order: int
    marker: str = ""

    def of_line(self) -> dict[str, Any]:
        """Return the arguments of matplotlib's plot."""
        return {
            "color": self.colour,
            "linewidth": self.width * rcParams["lines.linewidth"] / LINE,
            "linestyle": self.dashes,
            "dash_capstyle": "butt",
            "zorder": 2 + self.order,
            "marker": self.marker,
            "markersize": 3.0,
            "markerfacecolor": "none",
        }


PERIOD = 18.0  # of the dash patterns, in line widths

#: Styles of external curves, in order of files: black and grey, which no solution has, drawn
#: between engines and exact solutions.
GIVEN = (
    Style("#000000", 0.9, "-", 3, "o"),
    Style("#6e6e6e", 0.9, (0, (6, 2)), 3, "x"),
    Style("#000000", 0.9, (0, (1.5, 1.5)), 3, "s"),
    Style("#6e6e6e", 0.9, (0, (6, 2, 1.5, 2)), 3, "+"),
)
MOST_MARKS = 150  # largest number of samples with markers

#: Colours along the pillar, and of differences: diverging, perceptually uniform and safe for all
#: kinds of colour blindness (ColorBrewer). Tension is blue and compression red.
FIELD, DIFFERENCE = "RdBu_r", "PuOr_r"
UNSIGNED = "YlOrRd"  # from zero to the largest
GREY, PALE = "#5d6670", "#bbbbbb"  # of marks, and of the level of zero

#: Colours of the terms of an energy ledger: those of Tol (2021), "muted", and black.
TERMS = {
    "kinetic": "#332288",
    "elastic": "#cc6677",
    "viscous": "#117733",
    "friction": "#999933",
    "fracture": "#882255",
    "boundary": "#44aa99",
    "gravity": "#ddcc77",
    "work": "#000000",
}

RC: dict[Any, Any] = {
    "figure.figsize": (WIDTH, WIDTH),
    "savefig.dpi": 160,  # also of images in an SVG or PDF
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Helvetica", "Arial"],
    "font.size": SIZE,
    "lines.linewidth": LINE,
    "axes.titlesize": "medium",
    "axes.titlelocation": "left",
    "axes.titlepad": 3.0,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.xmargin": 0.0,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.fontsize": "medium",
    "legend.frameon": False,
    "svg.fonttype": "none",
    "path.simplify_threshold": 0.5,  # pixels: half of the thinnest line
}


def printed(width: float, size: float) -> dict[Any, Any]:
    """Return matplotlib's settings of a figure for print, which needs no installed fonts.

    width : of the figure, mm. size : of its letters, points.
    """
    return RC | {
        "figure.figsize": (width / 25.4, width / 25.4),
        "font.size": size,
        "lines.linewidth": 1.0,
        "savefig.dpi": 600,
        "pdf.fonttype": 42,  # TrueType
        "svg.fonttype": "path",
    }


def style(name: str) -> Style:
    """Return the style of an engine or exact solution; grey for one without a style.

    Every exact solution fills its own part of each period of dashes: where all of them coincide,
    their dashes alternate.
    """
    if name not in names():
        return Style("#777777", 1.1, (PERIOD, (9, PERIOD - 9)), 3)
    line = solver(name).line
    if not line.slot:
        return Style(line.colour, line.width, "-", line.order)
    first, last = line.slot
    dashes = (PERIOD - first, (last - first, PERIOD - (last - first)))
    return Style(line.colour, line.width, dashes, line.order)


def given_style(k: int, samples: int) -> Style:
    """Return the style of the k-th external file with this many samples."""
    found = GIVEN[k % len(GIVEN)]
    return found if samples <= MOST_MARKS else found._replace(marker="")
