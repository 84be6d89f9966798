"""A figure as files, its drawings and its numbers, and as what the page shows of it.

A page holds many SVGs of matplotlib: the ids of each are its own, and it has no more than is seen.
Of the paper's figures matplotlib writes 8 MB. Palettes for images take 1.6 MB of them away, two
decimals of a point 1.1, steps between the points of a path 2.2, and ids, groups and styles that
nothing follows 1.3: the page would be too large without. All of it takes 1 s for a scene whose
drawing takes 22.
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

DOTS = 160  # of the PNG, per inch
DIGITS = 6  # of the numbers behind a figure
#: Ids that matplotlib counts its parts by; those that a drawing gives to its own groups stay.
COUNTED = re.compile(
    r' id="(?:figure|axes|patch|line2d|text|legend|[xy]tick|matplotlib\.axis|[A-Z]\w+)_\d+"'
)
HASHED = re.compile(r"[A-Za-z]+[0-9a-f]{10}")
USE = re.compile(r'(<use xlink:href="#([^"]+)"[^>]*?) style="([^"]*)"')
PLACE = re.compile(r"([ML]) (-?[\d.]+(?:e-?\d+)?) (-?[\d.]+(?:e-?\d+)?) ?\n?")


@contextmanager
def blank(
    height: float, width: float = WIDTH, laid_out: bool = False, rc: dict[Any, Any] = RC
) -> Iterator[Figure]:
    """Give an empty figure to be drawn on, inches; constraints lay it out once that is done, unless
    the drawing lays it out itself."""
    with matplotlib.rc_context(rc):
        figure = Figure(figsize=(width, height))
        FigureCanvasAgg(figure)
        yield figure
        if not laid_out:
            figure.set_layout_engine("constrained")


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
        if isinstance(engine := figure.get_layout_engine(), ConstrainedLayoutEngine):
            engine.execute(figure)
        figure.set_layout_engine(None)
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


def compact(svg: str, name: str) -> str:
    """Return an SVG without what nobody sees; coordinates are to a hundredth of a point.

    name : what all ids begin with.
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
    """Return an SVG whose ids begin with its name; those that matplotlib makes up are short."""
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
    """Return a path of moves and lines by the steps between its rounded points; others as is."""
    points = PLACE.findall(path)
    if len(points) < 2 or PLACE.sub("", path).strip(" \nz"):
        return path
    found, at, last = "", (0, 0), ""
    for letter, *place in points:
        x, y = (round(100 * float(number)) for number in place)
        step = " ".join(_hundredths(now - before) for now, before in zip((x, y), at, strict=True))
        # Pairs after a move or a line are lines: without a letter, and without a space before "-".
        found += letter.lower() if letter == "M" or not last else " " * (step[0] != "-")
        found += step.replace(" -", "-")
        at, last = (x, y), letter
    return found + ("z" if path.rstrip().endswith("z") else "")


def _hundredths(n: int) -> str:
    """Return a number of hundredths in units, without a zero before the point."""
    return re.sub(r"^(-?)0\.", r"\1.", f"{n / 100:g}")


def _without_overruled_styles(svg: str) -> str:
    """Return an SVG whose uses say nothing of the stroke that the path itself says."""
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
    """Return an SVG without groups that have no attribute and hold nothing but elements drawn."""
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
    """Return a PNG in base64 with a palette where it has few colours: a tenth of the bytes."""
    image = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    if image.getcolors(256) is None:
        return png
    buffer = io.BytesIO()
    image.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(
        buffer, "PNG", optimize=True
    )
    return base64.b64encode(buffer.getvalue()).decode("ascii")
