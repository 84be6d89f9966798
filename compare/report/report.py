"""The report: the figures of Guo & Li (2002), or scenes of one's own, as one page."""

import logging
import platform
import shlex
from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave.compare import engines
from jointwave.compare.engines import Progress
from jointwave.compare.report import peers
from jointwave.compare.report.overview import lead
from jointwave.compare.report.page import render
from jointwave.compare.report.scenes import (
    ROCK_MASSES,
    SceneRequest,
    SolvedScene,
    asked_for,
    solve,
)
from jointwave.compare.report.scenes import planned as planned_of_scene
from jointwave.compare.report.sections import DIAGRAMS, sections
from jointwave.compare.report.sections import planned as planned_of_sections
from jointwave.compare.runs.output import write_text
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder
from jointwave.compare.runs.timings import machine
from jointwave.compare.scenes import load_variants
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import DIED, Pool, alone, in_processes
from jointwave.compare.text import percent

WORKERS = 2  # processes
SCENES = 0.4  # of the progress of the paper's page; studies and hard cases are the rest
LONG = 0.5  # s: a run that has taken so long is not repeated
PAPERS = (
    "Figures 2 to 10 of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124–1129, by rigid "
    "blocks, by a deformable continuum and by exact solutions"
)
log = logging.getLogger("jointwave")
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
    workers: int = WORKERS,
    scenes: Sequence[str] = (),
    peers_table: Path | None = None,
    hard: bool = True,
    stored: ResultFolder = NOWHERE,
) -> Report:
    """Solve scenes by all that applies, and write their figures, tables and `out`/index.html.

    `scenes` are files or names of shipped ones; without any, the page has the paper's figures and
    after them the studies. `progress` is called with the finished fraction of the whole. `workers`
    processes share the work. `peers_table` is what `make bench-peers` wrote; None: where it writes,
    if it did. `hard` : also put both engines to the hard cases. `stored` : the folder with a folder
    of results for each scene.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    tell, out = progress or (lambda fraction: None), Path(out)
    pool = partial(in_processes, workers)
    requests = asked_for(scenes)
    work = partial(solve, folder=out / "figures", stored=stored)
    if scenes:
        solved = _solve(work, requests, pool, tell)
        title = solved[0].scene.title if len(solved) == 1 else f"{len(solved)} scenes"
        command = f"jointwave report {shlex.join(dict.fromkeys(scenes))} --out DIR"
        page = _page(title, command, solved)
    else:
        others = peers.read(peers_table)
        requests += asked_for(ROCK_MASSES)
        solved = _solve(work, requests, pool, lambda x: tell(SCENES * x))
        studies = list(sections(out, pool, hard, others, lambda x: tell(SCENES + (1 - SCENES) * x)))
        paper, rock = solved[: -len(ROCK_MASSES)], solved[-len(ROCK_MASSES) :]
        page = _page(PAPERS, "jointwave report --out DIR", paper, rock, studies)
    return Report(write_text(out / "index.html", render(page, out)), page)


def planned(
    out: Path, scenes: Sequence[str], stored: ResultFolder
) -> tuple[list[Run], dict[str, int]]:
    """Return the runs of `build` by two processes, and how many of what else it does."""
    requests = asked_for(scenes) + ([] if scenes else asked_for(ROCK_MASSES))
    found = [run for one in requests for run in planned_of_scene(one, stored)]
    count = sum(len(load_variants(one.file)) for one in requests)
    parts = {"pages": count, "distances": count, "processes": WORKERS}
    if scenes:
        return found, parts
    return found + planned_of_sections(out), parts | {"diagrams": DIAGRAMS}


def _solve(
    work: Callable[[SceneRequest], SolvedScene],
    requests: list[SceneRequest],
    pool: Pool,
    progress: Progress,
) -> list[SolvedScene]:
    """Return the scenes, solved and drawn by processes, and timed anew while no other process
    should be computing, but for runs that take long."""
    found: dict[str, SolvedScene] = {}
    # Those of most variants first, so that all processes end together.
    ordered = sorted(requests, key=lambda one: -len(load_variants(one.file)))
    points = {one.name: one for one in ordered}
    for name, one in pool(work, points):
        if one is None:
            raise MemoryError(f"scene {name}: {DIED}")
        found[name] = one
        progress(len(found) / len(requests))
    if read := {one.request.file.stem: one.read for one in found.values() if one.read}:
        took = [seconds for each in read.values() for seconds in each]
        said = f"{len(took)} results of {', '.join(read)}, computed in {sum(took):.2g} s"
        log.info("reads %s; --fresh computes anew", said)
    with alone():
        return [_timed(found[one.name]) for one in requests]


def _timed(one: SolvedScene) -> SolvedScene:
    """Return a scene with the least seconds of stepping it of two runs."""

    def again(name: str, taken: float) -> float:
        return min(taken, engines.solve(name, one.scene).attrs["seconds_stepping"])

    return one._replace(seconds={k: s if s > LONG else again(k, s) for k, s in one.seconds.items()})


def _page(
    subtitle: str,
    command: str,
    solved: list[SolvedScene],
    rock: Sequence[SolvedScene] = (),
    studies: Sequence[dict[str, Any]] = (),
) -> dict[str, Any]:
    """Return what the templates show: scenes, the paper's or one's own, rock masses and studies."""
    every, numbered = [*solved, *rock], any(one.request.number for one in solved)
    links = {
        "Figures" if numbered else "Scenes": [(one.request.name, one.link) for one in solved],
        "Rock masses": [(one.request.name, one.link) for one in rock],
        "Studies": [(s["id"], s["contents"]) for s in studies if not s["appendix"]],
        "Appendix": [(s["id"], s["contents"]) for s in studies if s["appendix"]],
    }
    versions = {name: number for one in solved for name, number in one.versions.items()}
    versions |= {name: version(name) for name in PACKAGES}
    worst = {f"{one.request.label} (%)": one.worst for one in every}
    shown = next((one for one in solved if one.about), solved[0])
    return {
        "subtitle": subtitle,
        "command": command,
        "picture": shown.lead,
        "lead": lead(every),
        "summary": pd.concat(worst, axis=1),
        "claims": [(one.request, claim) for one in solved for claim in one.claims],
        "about": shown.about,
        "every_scene": every,
        "scenes": solved,
        "rock_masses": rock,
        "studies": studies,
        "contents": {heading: found for heading, found in links.items() if found},
        "machine": "{processor}, {cores} cores, numba {numba}".format_map(machine()),
        "versions": {"Python": platform.python_version()} | versions,
    }
