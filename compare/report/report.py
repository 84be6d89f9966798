"""The report: the figures of Guo & Li (2002), or scenes of one's own, as one page."""

import platform
import shlex
from collections.abc import Sequence
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import Progress
from jointwave.compare.report import peers
from jointwave.compare.report.overview import RankedScene, overview, seconds_of_stepping
from jointwave.compare.report.page import render
from jointwave.compare.report.scenes import (
    ROCK_MASSES,
    SceneRequest,
    SolvedScene,
    asked_for,
    solve,
)
from jointwave.compare.report.sections import section, sections
from jointwave.compare.runs.output import write_text
from jointwave.compare.runs.timings import measured_on
from jointwave.compare.studies.store import DIED, alone, in_processes, in_turn
from jointwave.compare.text import percent

SCENES = 0.4  # of the progress of the paper's page; studies and hard cases are the rest
PAPERS = (
    "Figures 2 to 10 of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124–1129, by rigid "
    "blocks, by a deformable continuum and by exact solutions"
)
PACKAGES = ("jointwave", "scipy", "xarray", "obspy", "matplotlib")


class Report(NamedTuple):
    """The HTML file of the report, and what its templates show."""

    file: Path
    page: dict[str, Any]

    @property
    def summary(self) -> pd.DataFrame:
        """Largest misfit of each pair of solutions in each scene in percent, as text."""
        cells = self.page["summary"].map(lambda x: percent(x / 100) if isfinite(x) else "")
        return cells.rename(columns=lambda name: name.removesuffix(" (%)"))


def build(
    out: Path,
    progress: Progress | None = None,
    workers: int = 2,
    scenes: Sequence[str] = (),
    peers_table: Path | None = None,
    hard: bool = True,
    ensembles: Sequence[Path] = (),
) -> Report:
    """Solve scenes by all that applies, and write their figures, tables and `out`/index.html.

    `scenes` are files or names of shipped ones; without any, the page has the paper's figures and
    after them the studies. `progress` is called with the finished fraction of the whole. `workers`
    processes share the work. `peers_table` is what `make bench-peers` wrote; None: where it writes,
    if it did. `hard` : also put both engines to the hard cases.
    `ensembles` : folders of ensembles of these scenes, whose pictures stand among theirs.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    tell, out = progress or (lambda fraction: None), Path(out)
    if scenes:
        page = _scenes_page(_solve(out, asked_for(scenes, ensembles), workers, tell))
        page["command"] = f"jointwave report {shlex.join(dict.fromkeys(scenes))} --out DIR"
    else:
        if ensembles:
            raise SceneError("--ensemble", str(ensembles[0]), None, "needs its scene")
        page = _paper_page(out, workers, peers.read(peers_table), hard, tell)
    return Report(write_text(out / "index.html", render(page, out)), page)


def _solve(
    out: Path, requests: list[SceneRequest], workers: int, progress: Progress
) -> list[SolvedScene]:
    """Return the scenes, solved and drawn by processes, and timed alone afterwards."""
    found: dict[str, SolvedScene] = {}
    run = partial(in_processes, workers) if workers > 1 else in_turn
    points = {one.name: one for one in requests}
    for name, one in run(partial(solve, folder=out / "figures"), points):
        if one is None:
            raise MemoryError(f"scene {name}: {DIED}")
        found[name] = one
        progress(len(found) / len(requests))
    solved = [found[one.name] for one in requests]
    with alone():
        timed = [seconds_of_stepping(one.scene, one.seconds) for one in solved]
    return [one._replace(seconds=s) for one, s in zip(solved, timed, strict=True)]


def _scenes_page(solved: list[SolvedScene]) -> dict[str, Any]:
    """Return what the page shows of scenes alone."""
    title = solved[0].title if len(solved) == 1 else f"{len(solved)} scenes"
    found = {"Python": platform.python_version()}
    for one in solved:
        found |= one.versions
    summary = pd.concat([one.worst.rename(f"{one.request.label} (%)") for one in solved], axis=1)
    numbered = any(one.request.number for one in solved)
    return {
        "subtitle": title,
        "overview": overview([_ranked(one) for one in solved]),
        "summary": summary,
        "claims": [(one.request, claim) for one in solved for claim in one.claims],
        "about": next((one.about for one in solved if one.about), None),
        "scenes": solved,
        "rock_masses": [],
        "studies": [],
        "contents": {"Figures" if numbered else "Scenes": _links(solved)},
        "machine": measured_on(),
        "versions": found | {name: _version(name) for name in PACKAGES},
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from its folder
        return "(not installed)"


def _ranked(one: SolvedScene) -> RankedScene:
    heading = f"{one.request.number or one.request.name} {one.title}"
    return RankedScene(one.request.name, heading, one.title, one.scores, one.seconds)


def _links(solved: list[SolvedScene]) -> list[tuple[str, str]]:
    numbers = (f"{one.request.number} " if one.request.number else "" for one in solved)
    return [(s.request.name, f"{n}{s.title}") for s, n in zip(solved, numbers, strict=True)]


def _paper_page(
    out: Path, workers: int, others: pd.DataFrame | None, hard: bool, progress: Progress
) -> dict[str, Any]:
    """Return what the page shows of the paper's figures, of rock masses and of studies."""
    requests = [*asked_for(()), *asked_for(ROCK_MASSES)]
    solved = _solve(out, requests, workers, lambda x: progress(SCENES * x))
    paper, rock = solved[: -len(ROCK_MASSES)], solved[-len(ROCK_MASSES) :]
    pool = partial(in_processes, workers) if workers > 1 else None
    studies = list(sections(out, pool, hard, lambda x: progress(SCENES + (1 - SCENES) * x)))
    if others is not None:
        place = next(i for i, one in enumerate(studies) if one["id"].startswith("study-"))
        found = peers.summarise(others, out / "studies")
        shown = section("peers", found, "make bench-peers", contents="Other codes")
        studies.insert(place + 1, shown)
    page = _scenes_page(paper)
    links = [(one["id"], one["contents"]) for one in studies]
    page["contents"] |= {"Rock masses": _links(rock), "Studies": links}
    return page | {
        "subtitle": PAPERS,
        "command": "jointwave report --out DIR",
        "rock_masses": rock,
        "rock_overview": overview([_ranked(one) for one in rock]),
        "studies": studies,
    }
