"""The page's HTML: one file that holds its figures, their files and the script of its charts."""

from __future__ import annotations

import base64
import gzip
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd
from jinja2 import Environment, PackageLoader
from markupsafe import Markup, escape

from compare.experiments.ablation.section import WorthSection
from compare.experiments.study.section import StudySection
from compare.figures.style import style
from compare.report.compression import pack_plot, pack_table
from compare.report.findings import Finding
from compare.report.motion import Motion
from compare.report.overview import Overview
from compare.report.peers import PeersSection
from compare.report.section import Section
from compare.report.tables import Table

LONG = 20_000  # bytes of a table


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
    studies: list[StudySection] = field(default_factory=list)
    peers: PeersSection | None = None
    peers_file: str = ""
    effects: WorthSection | None = None
    stability: StudySection | None = None
    motion: Motion | None = None

    @property
    def is_interactive(self) -> bool:
        """Whether any figure of the scenes can be zoomed."""
        return any(shown.drawn.plot for section in self.sections for shown in section.figures)

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
    environment = Environment(
        loader=PackageLoader("compare.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {
        "held_file": held_file,
        "held_plot": lambda text: base64.b64encode(pack_plot(text)).decode("ascii"),
        "place": lambda file: file.relative_to(out).as_posix(),
        "source": lambda name: Markup(_asset(environment, name)),
        "colour": lambda name: style(name).colour,
        "charts": charts,
    }
    environment.filters["units"] = unbroken
    return environment.get_template("report.html").render(page=page)


def held(content: str | bytes) -> str:
    """Return content as the page holds it: gzipped, in base64."""
    raw = content.encode() if isinstance(content, str) else content
    return base64.b64encode(gzip.compress(raw, mtime=0)).decode("ascii")


def held_file(file: Path) -> Markup:
    """Return the element that holds a file: of a long table the packed numbers, else its bytes."""
    raw = file.read_bytes()
    packed = None
    if file.suffix == ".csv" and len(raw) > LONG:
        packed = pack_table(pd.read_csv(file, keep_default_na=True))
    text = held(raw) if packed is None else base64.b64encode(packed).decode("ascii")
    about = f'id="held-{escape(file.name)}" data-kind="{"bytes" if packed is None else "table"}"'
    return Markup(f'<script type="text/plain" {about}>{text}</script>')


def charts() -> str:
    """Return plotly.js, which draws the interactive figures, as the page holds it."""
    from plotly.offline import get_plotlyjs

    return held(get_plotlyjs())


def unbroken(text: str) -> str:
    """Return text whose numbers do not break from their signs."""
    return text.replace(" %", "\u00a0%").replace("≤ ", "≤\u00a0")


def _asset(environment: Environment, name: str) -> str:
    assert environment.loader
    return environment.loader.get_source(environment, name)[0]
