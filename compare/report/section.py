"""One scene of the page: what is drawn of it, its distances, and what it shows."""

import re
import shlex
from collections.abc import Iterable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import NamedTuple

import cases
from compare.figures.export import Drawn, save
from compare.figures.figure import SceneFigure
from compare.figures.tables import distance_frame, reading_frame
from compare.misfit.pairs import Comparison
from compare.report import tables
from compare.report.findings import Finding, findings
from compare.report.reading_table import reading_table
from compare.report.verdict import Standing, standings
from compare.runs.output import write_csv

PAPER = Path(cases.__file__).parent / "guo-li-2002"


class SceneRequest(NamedTuple):
    """A scene of the report: its file, how its user calls it, its name on the page, and pictures
    that are there already."""

    file: Path
    called: str
    name: str
    besides: tuple[SceneFigure, ...] = ()

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

    folded : whether it stands in a fold. drawn : its files; None where the same picture stands
    further up: place, words : its id and what the link to it says.
    """

    title: str
    caption: str
    folded: bool
    drawn: Drawn | None = None
    place: str = ""
    words: str = ""


#: A picture, and its files while they are being written; None where it stands further up.
Begun = tuple[Shown, Future[Drawn] | None]


class Section(NamedTuple):
    """One scene of the page; `toml` is its file's text."""

    request: SceneRequest
    title: str
    source: str
    toml: str
    figures: list[Shown]
    distances_file: Path
    readings_file: Path | None
    findings: list[Finding]
    misfits: tables.Table
    distances: tables.Table
    readings: tables.Table
    runs: tables.Table
    reasons: tables.Table
    standings: dict[str, Standing]

    @property
    def name(self) -> str:
        """The section's name on the page."""
        return self.request.name

    @property
    def verdicts(self) -> tables.Table:
        """Where the engines stand in each variant."""
        return tables.verdict_table(self.standings)

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
    folder: Path, request: SceneRequest, comparisons: list[Comparison], figures: list[Shown]
) -> Section:
    """Return the section of a scene's variants; write its distances and what is read off into
    `folder`."""
    scene = comparisons[0].scene
    distances, readings = (folder / f"{request.name}-{x}.csv" for x in ("misfits", "readings"))
    read = reading_frame(comparisons)
    return Section(
        request,
        scene.title,
        scene.source or "",
        request.file.read_text(encoding="utf-8-sig"),
        figures,
        write_csv(distances, distance_frame(comparisons)),
        None if read.empty else write_csv(readings, read),
        findings(request.number, comparisons) if request.number else [],
        tables.misfit_table(comparisons),
        tables.distance_table(comparisons),
        reading_table(read),
        tables.run_table(comparisons),
        tables.reason_table(comparisons),
        standings(comparisons),
    )


def draw(folder: Path, picture: SceneFigure) -> Drawn:
    """Write a picture's files: those that the page offers."""
    p = picture
    return save(p.figure, folder, p.name, p.title, p.table, png=False)


def begin(
    folder: Path, pictures: Iterable[tuple[SceneRequest, SceneFigure]], executor: Executor
) -> dict[str, list[Begun]]:
    """Let an executor write the pictures of scenes, none of the same numbers twice; return them by
    the scene's name."""
    known: dict[str, tuple[str, str]] = {}
    found: dict[str, list[Begun]] = {}
    for request, p in pictures:
        first = known.get(p.numbers, ("", ""))
        known.setdefault(p.numbers, (f"{p.name}-figure", f"{request.label}: {p.title}"))
        files = None if first[0] else executor.submit(draw, folder, p)
        shown = Shown(p.title, p.caption, p.folded, None, *first)
        found.setdefault(request.name, []).append((shown, files))
    return found


def finish(begun: list[Begun]) -> list[Shown]:
    """Return pictures with their drawings, waited for."""
    return [one._replace(drawn=files.result()) if files else one for one, files in begun]
