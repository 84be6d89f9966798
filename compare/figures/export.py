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

from compare.figures.style import RC, WIDTH
from compare.runs.output import write, write_csv

DOTS = 160  # per inch of the PNG
DIGITS = 6  # of the numbers behind a figure


@contextmanager
def blank(
    height: float,
    width: float = WIDTH,
    laid_out: bool = False,
    rc: dict[Any, Any] = RC,
    dpi: float | None = None,
) -> Iterator[Figure]:
    """Yield an empty figure, sizes in inches; it is laid out by constraints afterwards, unless the
    drawing lays it out itself."""
    with matplotlib.rc_context(rc):
        figure = Figure(figsize=(width, height), dpi=dpi)
        FigureCanvasAgg(figure)
        yield figure
        if not laid_out:
            figure.set_layout_engine("constrained")


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
        write_drawing(drawn.file("svg"), figure, metadata={"Title": title, "Date": None})
        write_drawing(drawn.file("pdf"), figure, metadata={"Title": title, "CreationDate": None})
        if png:
            write_drawing(drawn.file("png"), figure, dpi=DOTS)
    return drawn


def write_drawing(path: Path, figure: Figure, **options: Any) -> Path:
    """Write a figure created in memory, in the format of the suffix: matplotlib's writers fail in
    many ways on a full disk."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:], **options)
    return write(path, lambda place: place.write_bytes(content.getbuffer()))
