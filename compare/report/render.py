"""The page's HTML: one file that holds its figures and their files."""

import base64
import gzip
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from jinja2 import Environment, PackageLoader
from markupsafe import Markup, escape

from compare.figures.export import Drawn
from compare.figures.snapshots import SnapshotsSection
from compare.figures.style import style
from compare.report.findings import Finding
from compare.report.overview import Overview
from compare.report.section import Section
from compare.report.tables import Table
from compare.studies.summary import Summary
from compare.text import in_seconds, mean_and_worst, percent, table_cell, times


class RockMasses(NamedTuple):
    """What the page shows of rock masses: scenes, where engines stand on them, and studies."""

    overview: Overview
    sections: list[Section]
    studies: list[Summary]


@dataclass(frozen=True)
class Page:
    """All that stands on the page.

    subtitle : what it is about. about : what the whole comes to, and whether that holds. summary :
    largest misfits by pair. machine : that seconds were measured on. peers_file : where the table
    of other codes is looked for, "" where the page is not about them. command : makes the page.
    """

    subtitle: str
    overview: Overview
    summary: Table
    sections: list[Section]
    command: str
    machine: str
    versions: dict[str, str]
    about: Finding | None = None
    studies: list[Summary] = field(default_factory=list)
    peers: Summary | None = None
    peers_file: str = ""
    effects: Summary | None = None
    stability: Summary | None = None
    rock_masses: RockMasses | None = None
    snapshots: SnapshotsSection | None = None

    @property
    def failed(self) -> list[tuple[Section, Finding]]:
        """The findings that do not hold, and where they stand."""
        return [(s, f) for s in self.sections for f in s.findings if not f.holds]

    @property
    def claims(self) -> int:
        """The number of findings of all scenes."""
        return sum(len(s.findings) for s in self.sections)


def render(page: Page, out: Path) -> str:
    """Return the page, which is to stand in `out`; the files it hands out are read from there."""
    loader = PackageLoader(__package__)
    environment = Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.globals |= {
        "held_file": held_file,
        "picture": picture,
        "place": lambda file: file.relative_to(out).as_posix(),
        "source": lambda name: Markup(loader.get_source(environment, name)[0]),
        "colour": lambda name: style(name).colour,
        "licences": licences,
    }
    environment.filters |= {
        "units": unbroken,
        "percent": percent,
        "peak": mean_and_worst,
        "seconds": in_seconds,
        "times": times,
        "grouped": grouped,
    }
    return environment.get_template("report.html").render(page=page)


def grouped(table: Table | pd.DataFrame) -> Table:
    """Return a table with its rows in groups of text."""
    if isinstance(table, Table):
        return table
    groups: dict[str, list[list[str]]] = {}
    for (heading, *labels), *values in table.itertuples(name=None):
        cells = [table_cell(x, name) for x, name in zip(values, table.columns, strict=True)]
        groups.setdefault(heading, []).append([*map(str, labels), *cells])
    return Table([*table.index.names[1:], *table.columns], groups)


def held(content: str | bytes) -> str:
    """Return content as the page holds it: gzipped, in base64."""
    raw = content.encode() if isinstance(content, str) else content
    return base64.b64encode(gzip.compress(raw, mtime=0)).decode("ascii")


def held_file(file: Path) -> Markup:
    """Return the element that holds a file."""
    text = held(file.read_bytes())
    return Markup(f'<script type="text/plain" id="held-{escape(file.name)}">{text}</script>')


def picture(drawn: Drawn) -> str:
    """Return the address of a drawing as the page holds it: ids within it are its own."""
    content = base64.b64encode(drawn.file("svg").read_bytes()).decode("ascii")
    return f"data:image/svg+xml;base64,{content}"


def licences() -> dict[str, str]:
    """Return the licence texts of what the page holds of others: the letters of its figures."""
    import matplotlib

    fonts = Path(matplotlib.get_data_path(), "fonts", "ttf", "LICENSE_DEJAVU")
    return {"DejaVu, the font of figures": fonts.read_text(encoding="utf-8")}


def unbroken(text: str) -> str:
    """Return text whose numbers do not break from their signs."""
    return text.replace(" %", "\u00a0%").replace("≤ ", "≤\u00a0")
