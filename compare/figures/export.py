"""A figure as files, its drawings and its numbers, and as shown on the page.

A page contains many SVGs of matplotlib: each has its own ids, and only what is visible. matplotlib
writes 8 MB for the paper's figures. Palettes for images save 1.6 MB of them, coordinates with two
decimals of a point 1.1, relative paths 2.2, and unused ids, groups and styles 1.3: without this the
page would be too large. All of it takes 1 s for a scene whose drawing takes 22.
"""

import base64
import io
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from pandas import DataFrame
from PIL import Image

from compare.figures.style import RC, WIDTH
from compare.runs.output import write, write_csv, write_text

DOTS = 160  # per inch of the PNG
DIGITS = 6  # of the numbers behind a figure
#: Automatic ids of matplotlib's parts; ids given by a drawing to its groups are kept.
COUNTED = re.compile(
    r' id="(?:figure|axes|patch|line2d|text|legend|[xy]tick|matplotlib\.axis|[A-Z]\w+)_\d+"'
)
HASHED = re.compile(r"[A-Za-z]+[0-9a-f]{10}")
USE = re.compile(r'(<use xlink:href="#([^"]+)"[^>]*?) style="([^"]*)"')
PLACE = re.compile(r"([ML]) (-?[\d.]+(?:e-?\d+)?) (-?[\d.]+(?:e-?\d+)?) ?\n?")


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
    """A written figure: NAME.svg, NAME.pdf and, if requested, NAME.png; its numbers NAME.csv.

    svg : the element's text for a page, with unique ids.
    plot : the figure for plotly.js as JSON, "" without.
    """

    name: str
    title: str
    folder: Path
    svg: str
    plot: str = ""

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
    plot: dict[str, Any] | None = None,
    png: bool = True,
) -> Drawn:
    """Write a figure's files and return it as drawn; without a table the caller writes the CSV.

    png : also as pixels.
    """
    if table is not None:
        write_csv(folder / f"{name}.csv", table, DIGITS)
    svg = _write_drawings(figure, folder, name, title, png)
    text = "" if plot is None else json.dumps(plot, separators=(",", ":"), allow_nan=False)
    return Drawn(name, title, folder, svg, text)


def _write_drawings(figure: Figure, folder: Path, name: str, title: str, png: bool) -> str:
    buffer = io.StringIO()
    with matplotlib.rc_context(RC | {"svg.hashsalt": name}):
        if isinstance(engine := figure.get_layout_engine(), ConstrainedLayoutEngine):
            engine.execute(figure)
        figure.set_layout_engine(None)
        figure.savefig(buffer, format="svg", metadata={"Title": title, "Date": None})
        about = {"Title": title, "CreationDate": None}
        write_drawing(folder / f"{name}.pdf", figure, metadata=about)
        if png:
            write_drawing(folder / f"{name}.png", figure, dpi=DOTS)
    svg = compact(buffer.getvalue(), name)
    write_text(folder / f"{name}.svg", svg)
    return svg[svg.index("<svg") :]


def write_drawing(path: Path, figure: Figure, **options: Any) -> Path:
    """Write a figure created in memory, in the format of the suffix: matplotlib's writers fail in
    many ways on a full disk."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:], **options)
    return write(path, lambda place: place.write_bytes(content.getbuffer()))


def compact(svg: str, name: str) -> str:
    """Return an SVG without invisible parts; coordinates are rounded to a hundredth of a point.

    name : prefix of all ids.
    """
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(?<= d=")[^"]+', lambda match: _relative(match[0]), svg)
    svg = re.sub(r"<[^>]+>", lambda match: re.sub(r"(\d\.\d\d)\d+", r"\1", match[0]), svg)
    svg = _without_overruled_styles(COUNTED.sub("", svg))
    svg = re.sub(r"image-rendering:[^;\"]*;?", "", svg)  # viewers smooth images unless told not to
    svg = svg.replace(' transform="rotate(-0 ', ' transform="rotate(0 ')
    svg = re.sub(r' transform="rotate\(0 [^"]*"', "", svg)
    svg = _with_one_family(_with_own_ids(svg, name))
    svg = _without_bare_groups(re.sub(r"\s+\n|\n\s+", "\n", _without_repeated_ids(svg)))
    return re.sub(r'(?<=data:image/png;base64,)[^"]+', lambda match: _with_palette(match[0]), svg)


def _with_own_ids(svg: str, name: str) -> str:
    """Return an SVG whose ids begin with its name; matplotlib's automatic ids are shortened."""
    short = sha256(name.encode()).hexdigest()[:6]
    ids = dict.fromkeys(re.findall(rf'\bid="(?!{name})([^"]+)"', svg))
    own = {x: f"{short}{i}" if HASHED.fullmatch(x) else f"{name}-{x}" for i, x in enumerate(ids)}
    return re.sub(r'(\bid="|url\(#|href="#)([^")]+)', lambda m: m[1] + own.get(m[2], m[2]), svg)


def _with_one_family(svg: str) -> str:
    families = set(re.findall(r"font-family: ([^;\"]+)", svg))
    if len(families) != 1:
        return svg
    (family,) = families
    svg = svg.replace(f"font-family: {family}; ", "")
    return svg.replace("<svg ", f'<svg font-family="{family}" ', 1)


def _relative(path: str) -> str:
    """Return a path of moves and lines in relative, rounded coordinates; other paths unchanged."""
    points = PLACE.findall(path)
    if len(points) < 2 or PLACE.sub("", path).strip(" \nz"):
        return path
    found, at, last = "", (0, 0), ""
    for letter, *place in points:
        x, y = (round(100 * float(number)) for number in place)
        step = " ".join(_hundredths(now - before) for now, before in zip((x, y), at, strict=True))
        # Pairs after a move or a line are lines: no letter, and no space before "-".
        found += letter.lower() if letter == "M" or not last else " " * (step[0] != "-")
        found += step.replace(" -", "-")
        at, last = (x, y), letter
    return found + ("z" if path.rstrip().endswith("z") else "")


def _hundredths(n: int) -> str:
    """Return a number of hundredths as a decimal, without a zero before the point."""
    text = f"{n / 100:g}"
    return text.replace("0.", ".", 1) if abs(n) < 100 else text


def _without_overruled_styles(svg: str) -> str:
    """Return an SVG whose uses do not repeat the stroke set by the path itself."""
    paths = re.findall(r'<path id="([^"]+)"[^>]*? style="([^"]*)"', svg)
    own = {name: {part.partition(":")[0].strip() for part in s.split(";")} for name, s in paths}

    def shortened(match: re.Match) -> str:
        said = [part.strip() for part in match[3].split(";")]
        kept = [
            x
            for x in said
            if (key := x.partition(":")[0]) not in own.get(match[2], ())
            or not key.startswith("stroke")
        ]
        return match[1] + (f' style="{"; ".join(kept)}"' if kept else "")

    return USE.sub(shortened, svg)


def _without_bare_groups(svg: str) -> str:
    """Return an SVG without groups that have no attribute and contain only drawn elements."""
    count = 1
    while count:
        svg, count = re.subn(r"<g>\n((?:<(?:use|path)\b[^>]*/>\n)*)</g>\n", r"\1", svg)
    return svg


def _without_repeated_ids(svg: str) -> str:
    seen: set[str] = set()

    def once(match: re.Match) -> str:
        found = "" if match[1] in seen else match[0]
        seen.add(match[1])
        return found

    return re.sub(r' id="([^"]+)"', once, svg)


def _with_palette(png: str) -> str:
    """Return a PNG in base64 with a palette if it has few colours: a tenth of the bytes."""
    image = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    if image.getcolors(256) is None:
        return png
    buffer = io.BytesIO()
    image.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(
        buffer, "PNG", optimize=True
    )
    return base64.b64encode(buffer.getvalue()).decode("ascii")
