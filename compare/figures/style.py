"""Styles and units of figures: one hue per model, one line pattern per kind of solution, and
multiples of units suited to the size of numbers.

Engines are wide, light, solid lines of different widths, so that none hides another; exact
solutions are thin, dark, dashed lines over them. Hues are those of Okabe & Ito (2008),
distinguishable with any colour blindness.
"""

from pathlib import Path
from typing import Any, NamedTuple

from matplotlib import rc_params_from_file

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import names, solver
from jointwave.compare.solvers.record import Line, thin
from jointwave.results.labels import QUANTITIES, label

#: Styles of external curves, in order of files: black and grey, used by no solution, drawn between
#: engines and exact solutions.
GIVEN = (
    Line("#000000", 0.9, 3, "-", "o"),
    Line("#6e6e6e", 0.9, 3, (0, (6, 2)), "x"),
    Line("#000000", 0.9, 3, (0, (1.5, 1.5)), "s"),
    Line("#6e6e6e", 0.9, 3, (0, (6, 2, 1.5, 2)), "+"),
)
MOST_MARKS = 150  # largest number of samples with markers

#: Colour maps of fields along the pillar and of differences: diverging, perceptually uniform,
#: distinguishable with any colour blindness (ColorBrewer). Tension is blue and compression red.
FIELD, DIFFERENCE = "RdBu_r", "PuOr_r"
UNSIGNED = "YlOrRd"  # colour map from zero to the largest value
GREY, PALE = "#5d6670", "#bbbbbb"  # of marks, and of the zero line

#: Colours of the terms of an energy ledger: "muted" of Tol (2021), and black.
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

#: Matplotlib's settings of the page's figures.
RC: dict[Any, Any] = dict(
    rc_params_from_file(Path(__file__).with_name("page.mplstyle"), use_default_template=False)
)
WIDTH = RC["figure.figsize"][0]  # inches
SIZE = RC["font.size"]  # points


def printed(width: float, size: float) -> dict[Any, Any]:
    """Return matplotlib's settings for a printed figure, which needs no installed fonts.

    width : of the figure, mm. size : of the font, points. Raises SceneError if the legend has no
    room.
    """
    if width < (least := 5 * size):
        allowed = f"must be at least {least:g} mm for a font of {size:g} pt"
        raise SceneError("--width", f"{width:g}", None, allowed)
    return RC | {
        "figure.figsize": (width / 25.4, width / 25.4),
        "font.size": size,
        "lines.linewidth": 1.0,
        "savefig.dpi": 600,
        "pdf.fonttype": 42,  # TrueType
        "svg.fonttype": "path",
    }


def style(name: str) -> Line:
    """Return the line of an engine or exact solution; grey for any other name."""
    return solver(name).line if name in names() else thin("#777777", 3, (0, 9))


MULTIPLES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}

#: SI units of the quantities of waveforms.
UNITS = {name: label(name)["units"] for name in QUANTITIES}


class Unit(NamedTuple):
    """A multiple of an SI unit ("kPa") and its size in SI units."""

    name: str
    size: float


#: Units of waveforms on the page, by SI unit: the same for all scenes.
DRAWN = {
    "Pa": Unit("MPa", 1e6),
    "m/s": Unit("m/s", 1.0),
    "m": Unit("mm", 1e-3),
    "rad": Unit("mrad", 1e-3),
}


def in_unit(value: float, si: str) -> str:
    """Return a value with a suitable multiple of its unit, as text."""
    unit = unit_for(si, abs(value))
    return f"{value / unit.size:.3g} {unit.name}"


def unit_for(si: str, largest: float) -> Unit:
    """Return the multiple of a unit that brings `largest` between 1 and 1000, else the unit."""
    units = (Unit(prefix + si, size) for prefix, size in MULTIPLES.items())
    return next((one for one in units if 1 <= largest / one.size < 1000), Unit(si, 1.0))
