"""A figure as files: its drawings, SVG, PDF and PNG, and its numbers, CSV."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from pandas import DataFrame

from jointwave.compare.figures.style import RC
from jointwave.compare.runs.output import write, write_csv

DIGITS = 6  # of the numbers behind a figure


class ShownFigure(Figure):
    """A figure that a notebook shows where a cell ends with it, like those of pyplot."""

    def _repr_png_(self) -> bytes:
        self.savefig(found := io.BytesIO(), format="png")
        return found.getvalue()


@contextmanager
def blank(height: float, rc: dict[Any, Any] = RC) -> Iterator[Figure]:
    """Yield an empty figure, as wide as matplotlib's settings `rc` have it; height : inches."""
    with matplotlib.rc_context(rc):
        width = matplotlib.rcParams["figure.figsize"][0]
        figure = ShownFigure((width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


class SceneFigure(NamedTuple):
    """A figure of a scene and its solutions.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. table : the drawn data, tidy; columns carry their
    units, no index. folded : whether it is in a section of the page that is closed at first.
    """

    name: str
    title: str
    caption: str
    figure: Figure
    table: DataFrame
    folded: bool = False


class Drawn(NamedTuple):
    """A written figure: NAME.svg, NAME.pdf and, if requested, NAME.png; its numbers NAME.csv.

    caption : on the page. folded : whether it stands in a fold there.
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
        """The files of its drawings, if it also has pixels."""
        return [self.file(kind) for kind in ("svg", "pdf", "png")]


def save(
    figure: Figure,
    folder: Path,
    name: str,
    title: str,
    table: DataFrame | None = None,
    png: bool = True,
) -> Drawn:
    """Write a figure's files; without a table the caller writes the CSV.

    png : also as pixels.
    """
    drawn = Drawn(name, title, folder)
    if table is not None:
        write_csv(drawn.file("csv"), table, DIGITS)
    for path in drawn.drawings[: 3 if png else 2]:
        write_drawing(path, figure, title)
        figure.set_layout_engine("none")  # the first has laid it out
    return drawn


def write_drawing(path: Path, figure: Figure, title: str = "", rc: dict[Any, Any] = RC) -> Path:
    """Write a figure in the format of the suffix, .svg, .pdf or .png; the same figure is the same
    file. It is created in memory: matplotlib's writers fail in many ways on a full disk."""
    kind, content = path.suffix[1:], io.BytesIO()
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(kind, {})
    with matplotlib.rc_context(rc | {"svg.hashsalt": title}):
        figure.savefig(content, format=kind, metadata={"Title": title} | undated)
    return write(path, lambda place: place.write_bytes(content.getbuffer()))
