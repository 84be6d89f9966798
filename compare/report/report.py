"""The report: one HTML page with the figures of Guo & Li (2002), or with the user's own scenes."""

import logging
import platform
import shlex
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib.metadata import version
from operator import call
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from jointwave.compare import engines
from jointwave.compare.engines import Progress, in_words, label_of
from jointwave.compare.figures.style import style
from jointwave.compare.report import peers
from jointwave.compare.report.scenes import (
    ROCK_MASSES,
    SceneRequest,
    SolvedScene,
    asked_for,
    lead,
    solve,
)
from jointwave.compare.report.scenes import planned as planned_of_scene
from jointwave.compare.report.sections import DIAGRAMS, MOVING, sections
from jointwave.compare.report.sections import planned as planned_of_sections
from jointwave.compare.runs.output import write_text
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder
from jointwave.compare.runs.timings import machine
from jointwave.compare.scenes import load_variants
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import DIED, FAILURES, Pool, alone, in_processes
from jointwave.compare.text import grouped, in_seconds, percent, table_cell, times

WORKERS = 2  # processes
SCENES = 0.4  # of the progress of the paper's page; the rest are studies and hard cases
LONG = 0.5  # s; longer runs are not timed again
PAPERS = (
    "Figures 2 to 10 of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124–1129, by rigid "
    "blocks, by a deformable continuum and by exact solutions"
)
log = logging.getLogger("jointwave")
PACKAGES = ("jointwave", "scipy", "xarray", "obspy", "matplotlib")


class Report(NamedTuple):
    """The HTML file of the report, and the data of its templates."""

    file: Path
    page: dict[str, Any]


def build(
    out: Path,
    progress: Progress | None = None,
    workers: int = WORKERS,
    scenes: Sequence[str] = (),
    peers_table: Path | None = None,
    hard: bool = True,
    stored: ResultFolder = NOWHERE,
) -> Report:
    """Solve scenes with all solvers that apply; write figures, tables and `out`/index.html.

    scenes : files or names of shipped scenes; if empty, the page has the paper's figures and the
    studies. progress : called with the finished fraction. workers : number of processes.
    peers_table : the table of `make bench-peers`; None: its default file, if it exists. hard : also
    run the hard cases. stored : folder with a folder of results for each scene.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    tell, out, pool = progress or (lambda fraction: None), Path(out), partial(in_processes, workers)
    work = partial(solve, folder=out / "figures", stored=stored)
    requests, part, rock, studies = asked_for(scenes), 1.0, list[SolvedScene](), []
    moving = dict[str, Callable[[], Any]]()
    if not scenes:
        others, part = peers.read(peers_table), SCENES
        requests += asked_for(ROCK_MASSES)
        moving = {name: partial(make, out) for name, make in MOVING.items()}
    solved, shown = _solve(work, requests, moving, pool, lambda x: tell(part * x))
    title = solved[0].scene.title if len(solved) == 1 else f"{len(solved)} scenes"
    if not scenes:
        made = sections(out, pool, hard, others, lambda x: tell(part + (1 - part) * x))
        studies = [*made, *shown]
        solved, rock, title = solved[: -len(ROCK_MASSES)], solved[-len(ROCK_MASSES) :], PAPERS
    command = shlex.join(["jointwave", "report", *dict.fromkeys(scenes), "--out", "DIR"])
    page = _page(title, command, solved, rock, studies)
    return Report(write_text(out / "index.html", render(page, out)), page)


def planned(
    out: Path, scenes: Sequence[str], stored: ResultFolder
) -> tuple[list[Run], dict[str, int]]:
    """Return the runs of `build` with two processes, and the numbers of its other tasks by kind."""
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
    others: Mapping[str, Callable[[], Any]],
    pool: Pool,
    progress: Progress,
) -> tuple[list[SolvedScene], list[Any]]:
    """Return the scenes, solved and drawn in parallel, and the results of other functions; short
    runs are then timed again alone."""
    found = dict[str, Any]()
    # The others, and scenes with most variants, first: all processes end at nearly the same time.
    ordered = sorted(requests, key=lambda one: -len(load_variants(one.file)))
    tasks = {**others, **{one.name: partial(work, one) for one in ordered}}
    for name, one in pool(call, tasks):
        if one is None:
            raise MemoryError(f"scene {name}: {DIED}")
        found[name] = one
        progress(len(found) / len(tasks))
    solved = [found[one.name] for one in requests]
    if read := {one.request.file.stem: one.read for one in solved if one.read}:
        took = [seconds for each in read.values() for seconds in each]
        said = f"{len(took)} results of {', '.join(read)}, computed in {sum(took):.2g} s"
        log.info("reads %s; --fresh computes anew", said)
    with alone():
        for one in solved:
            for name, taken in one.seconds.items():
                with suppress(*FAILURES):  # an engine may solve only another variant
                    if taken <= LONG:
                        again = engines.solve(name, one.scene).attrs["seconds_stepping"]
                        one.seconds[name] = min(taken, again)
    return solved, [found[name] for name in others]


def _page(
    subtitle: str,
    command: str,
    solved: list[SolvedScene],
    rock: Sequence[SolvedScene] = (),
    studies: Sequence[dict[str, Any]] = (),
) -> dict[str, Any]:
    """Return the data of the templates."""
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


def render(page: dict[str, Any], out: Path) -> str:
    """Return the HTML of the page, with links relative to `out`.

    page : data of the templates, from `_page`.
    """
    loader = PackageLoader(__package__)
    environment = Environment(
        loader=loader,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.globals |= {
        "style": Markup(loader.get_source(environment, "page.css")[0]),
        "colour": lambda name: style(name).colour,
        "label": label_of,
        "link": lambda file: file.relative_to(out).as_posix(),
    }
    environment.filters |= {
        "picture": _picture,
        "units": _unbroken,
        "percent": percent,
        "times": times,
        "in_seconds": in_seconds,
        "rows": _rows,
    }
    return environment.get_template("report.html").render(page)


def _picture(file: Path) -> str:
    """Return an SVG or GIF image as a data URL."""
    kind = {".svg": "svg+xml", ".gif": "gif"}[file.suffix]
    return f"data:image/{kind};base64,{b64encode(file.read_bytes()).decode('ascii')}"


def _unbroken(text: str) -> str:
    """Return text with no-break spaces between numbers and signs."""
    return text.replace(" %", "\u00a0%").replace("≤ ", "≤\u00a0")


def _rows(table: pd.DataFrame) -> Markup:
    """Return a table in HTML, with equal row labels grouped, and names of solutions in words."""
    cells = grouped(table).apply(lambda c: c.map(lambda x: in_words(table_cell(x, str(c.name)))))
    cells = cells.rename(index=in_words, columns=in_words)
    named = table.index.names != [None]
    return Markup(cells.to_html(border=0, index=named, justify="unset"))
