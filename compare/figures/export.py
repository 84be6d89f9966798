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

from jointwave.compare.figures.style import RC, WIDTH
from jointwave.compare.runs.output import write, write_csv

DOTS = 160  # per inch of the PNG, and of images in the SVG and the PDF
DIGITS = 6  # of the numbers behind a figure


@contextmanager
def blank(
    height: float,
    width: float = WIDTH,
    laid_out: bool = False,
    rc: dict[Any, Any] = RC,
    dpi: float | None = None,
) -> Iterator[Figure]:
    """Yield an empty figure, sizes in inches; matplotlib lays it out by constraints, unless the
    drawing lays it out itself."""
    with matplotlib.rc_context(rc):
        figure = Figure((width, height), dpi=dpi, layout=None if laid_out else "constrained")
        FigureCanvasAgg(figure)
        yield figure


class Drawn(NamedTuple):
    """A written figure: NAME.svg, NAME.pdf and, if requested, NAME.png; its numbers NAME.csv."""

    name: str
    title: str
    folder: Path

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
    with matplotlib.rc_context(RC | {"svg.hashsalt": name}):
        for kind, dated in (("svg", "Date"), ("pdf", "CreationDate")):
            about = {"Title": title, dated: None}
            write_drawing(drawn.file(kind), figure, dpi=DOTS, metadata=about)
        if png:
            write_drawing(drawn.file("png"), figure, dpi=DOTS)
    return drawn


def write_drawing(path: Path, figure: Figure, **options: Any) -> Path:
    """Write a figure created in memory, in the format of the suffix: matplotlib's writers fail in
    many ways on a full disk."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:], **options)
    return write(path, lambda place: place.write_bytes(content.getbuffer()))
