"""One scene of the page: what is drawn of it, its distances, and what it shows."""

from __future__ import annotations

import re
import shlex
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import xarray as xr

import cases
from compare.figures.export import Drawn, save
from compare.figures.figure import SceneFigure
from compare.figures.scene_figures import figures_of
from compare.misfit.pairs import Comparison
from compare.report import tables
from compare.report.findings import Finding, findings
from compare.report.verdict import Standing, standings
from compare.runs.output import write_csv

PAPER = Path(cases.__file__).parent / "guo-li-2002"
Fields = list[dict[str, xr.Dataset]]
#: What two drawings of the same may differ by: the names of their parts, and their titles.
NAMES = re.compile(r"<title>.*?</title>|(?:\bid=\"|url\(#|href=\"#)[^\")]*", re.DOTALL)


class SceneRequest(NamedTuple):
    """A scene of the report: its file, how its user calls it, and its name on the page."""

    file: Path
    called: str
    name: str

    @property
    def number(self) -> int | None:
        """Of the paper's figure that the scene is; None for any other scene."""
        found = re.fullmatch(r"fig-(\d+)", self.file.stem)
        return int(found[1]) if found and self.file.resolve().parent == PAPER.resolve() else None

    @property
    def label(self) -> str:
        """What a column or a link calls it."""
        return f"fig. {self.number}" if self.number else self.name


class Shown(NamedTuple):
    """A picture as it stands on the page.

    folded : whether it stands in a fold. marks : what no other picture of the page shares. place,
    words : the id and the words of the same picture further up, which is linked to in its place.
    """

    drawn: Drawn
    folded: bool
    marks: frozenset[str]
    place: str = ""
    words: str = ""


class Section(NamedTuple):
    """One scene of the page; `toml` is its file's text."""

    request: SceneRequest
    title: str
    source: str
    toml: str
    figures: list[Shown]
    distances_file: Path
    findings: list[Finding]
    misfits: tables.Table
    distances: tables.Table
    runs: tables.Table
    reasons: tables.Table
    standings: dict[str, Standing]

    @property
    def name(self) -> str:
        """The section's name on the page."""
        return self.request.name

    @property
    def heading(self) -> str:
        """What stands above it."""
        number = self.request.number
        return f"Figure {number}. {self.title}" if number else self.title

    @property
    def command(self) -> str:
        """What makes the same again."""
        return shlex.join(["jointwave", "report", self.request.called, "--out", self.name])


def make_section(
    folder: Path, request: SceneRequest, comparisons: list[Comparison], fields: Fields
) -> Section:
    """Draw all pictures of a scene's variants, write their files into `folder`, return its section.

    fields : each variant's results all along the pillar, for space-time diagrams.
    """
    scene = comparisons[0].scene
    pictures = figures_of(request.name, comparisons, fields)
    distances = folder / f"{request.name}-misfits.csv"
    return Section(
        request,
        scene.title,
        scene.source or "",
        request.file.read_text(encoding="utf-8-sig"),
        [draw(folder, picture) for picture in pictures],
        write_csv(distances, tables.distance_frame(comparisons)),
        findings(request.number, comparisons) if request.number else [],
        tables.misfit_table(comparisons),
        tables.distance_table(comparisons),
        tables.run_table(comparisons),
        tables.reason_table(comparisons),
        standings(comparisons),
    )


def draw(folder: Path, picture: SceneFigure) -> Shown:
    """Write a picture's files: those that the page offers."""
    p = picture
    drawn = save(p.static, folder, p.name, p.title, p.table, p.caption, p.plot, png=False)
    numbers = drawn.file("csv").read_bytes()
    seen = NAMES.sub("", drawn.svg)
    return Shown(
        drawn, p.folded, frozenset(sha256(x).hexdigest() for x in (seen.encode(), numbers))
    )


def linked(sections: list[Section]) -> list[Section]:
    """Return sections in which no picture stands twice: a later one is a link to the first, and its
    files are removed. One is the same where its drawing is, or its numbers are."""
    known: dict[str, tuple[str, str]] = {}
    found = []
    for section in sections:
        figures = []
        for shown in section.figures:
            first = next((known[mark] for mark in shown.marks if mark in known), None)
            if first is None:
                words = f"{section.request.label}: {shown.drawn.title}"
                known |= dict.fromkeys(shown.marks, (f"{shown.drawn.name}-figure", words))
                figures.append(shown)
                continue
            for kind in ("svg", "pdf", "csv"):
                shown.drawn.file(kind).unlink(missing_ok=True)
            figures.append(shown._replace(place=first[0], words=first[1]))
        found.append(section._replace(figures=figures))
    return found
