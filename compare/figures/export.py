"""A figure as files, its drawings and its numbers, and as what the page shows of it."""

import io
import json
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from pandas import DataFrame

from compare.figures.style import RC
from compare.figures.svg import compact
from compare.runs.output import write, write_csv, write_text

DOTS = 160  # of the PNG, per inch
DIGITS = 6  # of the numbers behind a figure


class Drawn(NamedTuple):
    """A figure that is written: NAME.svg, NAME.pdf and, if asked, NAME.png; its numbers NAME.csv.

    svg : the element's text, ready to stand in a page; no other figure has its ids.
    caption : what is seen. plot : the figure for plotly.js as JSON, "" without.
    """

    name: str
    title: str
    folder: Path
    svg: str
    caption: str = ""
    plot: str = ""

    def file(self, kind: str) -> Path:
        """Return the figure's file of a kind, "pdf"."""
        return self.folder / f"{self.name}.{kind}"

    @property
    def drawings(self) -> list[Path]:
        """The files of its drawings where it has pixels too."""
        return [self.file(kind) for kind in ("svg", "pdf", "png")]


def save(
    figure: Figure,
    folder: Path,
    name: str,
    title: str,
    table: DataFrame | None = None,
    caption: str = "",
    plot: dict[str, Any] | None = None,
    png: bool = True,
) -> Drawn:
    """Write a figure's files and return it as drawn; without a table its CSV is the caller's.

    png : also as pixels.
    """
    if table is not None:
        write_csv(folder / f"{name}.csv", table, DIGITS)
    svg = _write_drawings(figure, folder, name, title, png)
    text = "" if plot is None else json.dumps(plot, separators=(",", ":"), allow_nan=False)
    return Drawn(name, title, folder, svg, caption, text)


def _write_drawings(figure: Figure, folder: Path, name: str, title: str, png: bool) -> str:
    buffer = io.StringIO()
    with matplotlib.rc_context(RC | {"svg.hashsalt": name}):
        _lay_out(figure)
        figure.savefig(buffer, format="svg", metadata={"Title": title, "Date": None})
        about = {"Title": title, "CreationDate": None}
        _write_bytes(folder / f"{name}.pdf", figure, metadata=about)
        if png:
            _write_bytes(folder / f"{name}.png", figure, dpi=DOTS)
    svg = compact(buffer.getvalue(), name)
    write_text(folder / f"{name}.svg", svg)
    return svg[svg.index("<svg") :]


def _write_bytes(path: Path, figure: Figure, **options: Any) -> None:
    """Write a figure that is made in memory: its writers fail in many ways on a full disk."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:], **options)
    write(path, lambda place: place.write_bytes(content.getbuffer()))


def _lay_out(figure: Figure) -> None:
    """Lay a figure out for good: its files need not do so again, each twice."""
    if isinstance(engine := figure.get_layout_engine(), ConstrainedLayoutEngine):
        engine.execute(figure)
    figure.set_layout_engine(None)
