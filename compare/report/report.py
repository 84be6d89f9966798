"""The report: the figures of Guo & Li (2002), or scenes of one's own, as one page."""

import shlex
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

from pandas import DataFrame

from cases.errors import SceneError
from compare.engines import Progress
from compare.experiments.ablation import runner as ablation_runs
from compare.experiments.ablation.summary import summarise as summarise_ablation
from compare.experiments.cost.timings import measured_on
from compare.experiments.scattering import summary as scattering
from compare.experiments.study.study import load as load_study
from compare.experiments.study.summary import REPORTED
from compare.experiments.study.summary import reported as reported_studies
from compare.experiments.study.summary import run as run_study
from compare.experiments.study.summary import summarise as summarise_study
from compare.figures.snapshots import SnapshotsSection, make_snapshots
from compare.report import peers, tables
from compare.report.findings.pillar import mostly_dispersion
from compare.report.overview import Overview, RankedScene, seconds, versions
from compare.report.render import Page, RockMasses, render
from compare.report.scenes import ROCK_MASSES, Pool, Solved, asked_for, solve
from compare.report.section import SceneRequest
from compare.runs.output import write_text
from compare.runs.workers import Workers
from compare.studies.hard_cases import make_study as make_hard_cases
from compare.studies.store import alone, on_executor
from compare.studies.summary import Summary

FREE_PILLAR = "fig-03"  # the scene that says what the paper's own comparison is made of
#: How much of the paper's page each part takes, %, where kernels are compiled.
PARTS = {"scenes": 30, "hard cases": 40, "studies": 10, "rock masses": 10, "effects": 10}
PAPERS = (
    "Figures 2 to 10 of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124–1129, by rigid "
    "blocks, by a deformable continuum and by exact solutions"
)


class Report(NamedTuple):
    """The HTML file of the report, and what stands on its page."""

    file: Path
    page: Page


class Lent(Executor):
    """An executor that is not shut down by its users."""

    def __init__(self, executor: Executor) -> None:
        self.submit = executor.submit  # type: ignore[method-assign]


def _shared(pool: Pool) -> Callable[..., Any]:
    """Return how studies use the executor of the report."""
    return partial(on_executor, pool())


class _Untimed(NamedTuple):
    """The hard cases, None where they are left out, what joints reflect and pass, and the studies
    that are not timed, by name."""

    stability: Summary | None
    joints: list[Summary]
    studies: dict[str, Summary]


def build(
    out: Path,
    progress: Progress | None = None,
    workers: int = 2,
    scenes: Sequence[str] = (),
    studies: tuple[str, ...] = REPORTED,
    peers_table: Path | None = None,
    hard: bool = True,
    ensembles: Sequence[Path] = (),
    executor: Executor | None = None,
) -> Report:
    """Solve scenes by all that applies, and write their figures, tables and `out`/index.html.

    `scenes` are files or names of shipped ones; without any, the page has the paper's figures and
    after them the studies. `progress` is called with the finished fraction of the whole.
    `peers_table` is what `make bench-peers` wrote; None: where it writes, if it did.
    `hard` : also put both engines to the hard cases, except those that take long.
    `ensembles` : folders of ensembles of these scenes, whose pictures stand among theirs.
    `executor` : does the work; None: so many `workers`.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    given = Workers(workers) if executor is None else nullcontext(executor)
    with ThreadPoolExecutor(1) as beside, given as lent:
        pool = partial(Lent, lent)
        if scenes:
            page = _of_scenes(Path(out), asked_for(scenes, ensembles), progress, pool)
        else:
            if ensembles:
                raise SceneError("--ensemble", str(ensembles[0]), None, "needs its scene")
            others = peers.read(peers_table)
            part = _parts(progress)
            untimed: list[Future[_Untimed]] = []

            def begin() -> None:
                untimed.append(beside.submit(_untimed, Path(out), hard, studies, pool, part))

            solved = _solved(Path(out), part("scenes"), pool, begin)
            made = untimed[0].result()
            page = _of_paper(*solved, made)
            page = _with_measured(page, Path(out), studies, made, others, pool, part)
    return Report(write_text(Path(out) / "index.html", render(page, Path(out))), page)


def _parts(progress: Progress | None) -> Callable[[str], Progress]:
    """Return what gives each part of the paper's page its progress, of the whole the sum."""
    done, lock = dict.fromkeys(PARTS, 0.0), Lock()

    def part(name: str) -> Progress:
        def tell(fraction: float) -> None:
            with lock:
                done[name] = fraction
                if progress is not None:
                    progress(sum(share * done[one] for one, share in PARTS.items()) / 100)

        return tell

    return part


def _of_scenes(out: Path, asked: list[SceneRequest], progress: Progress | None, pool: Pool) -> Page:
    """Return the page of some scenes alone."""
    solved = solve(out / "figures", asked, progress, pool)
    count = len(solved.sections)
    about = solved.sections[0].title if count == 1 else f"{count} scenes"
    return _page(
        solved,
        about,
        shlex.join(["jointwave", "report", *(one.called for one in asked), "--out", "DIR"]),
    )


def _solved(
    out: Path, progress: Progress, pool: Pool, begin: Callable[[], None]
) -> tuple[Solved, SnapshotsSection]:
    """Return the paper's scenes and those of rock masses, and the snapshots; `begin` is called when
    all of theirs is on its way."""
    snapshots: list[Future] = []

    def besides(executor: Executor) -> list[Future]:
        snapshots.append(executor.submit(make_snapshots, out))
        return snapshots

    asked = [*asked_for(()), *asked_for(ROCK_MASSES)]
    return solve(out / "figures", asked, progress, pool, besides, begin), snapshots[0].result()


def _untimed(
    out: Path, hard: bool, studies: tuple[str, ...], pool: Pool, part: Callable[[str], Progress]
) -> _Untimed:
    """Return what is made beside the scenes: processors are busy, and no seconds are measured.

    All of it at once: where one part ends, no processor waits for the next. Results without
    effects are only computed, and read where they are needed.
    """
    with ThreadPoolExecutor() as threads:
        joints = threads.submit(_joints, out / "studies", pool, part("rock masses"))
        others = threads.submit(_untimed_studies, out / "studies", studies, pool)
        cases = ablation_runs.reported()
        effects = threads.submit(ablation_runs.prepared, cases, out / "effects", _shared(pool))
        tell = part("hard cases")
        stability = make_hard_cases(out / "studies", _shared(pool), tell) if hard else None
        tell(1.0)  # also where they are left out
        effects.result()
        return _Untimed(stability, joints.result(), others.result())


def _joints(folder: Path, pool: Pool, progress: Progress) -> list[Summary]:
    """Return the studies of what joints reflect and pass, drawn by processes of the pool."""
    for i, name in enumerate(scattering.TITLES, start=1):
        scattering.run(name, folder / name, None, True, _shared(pool))
        progress(i / len(scattering.TITLES))
    with pool() as executor:
        made = partial(scattering.make_study, out=folder, brief=True)
        return [one.result() for one in [executor.submit(made, x) for x in scattering.TITLES]]


def _untimed_studies(folder: Path, studies: tuple[str, ...], pool: Pool) -> dict[str, Summary]:
    """Return the studies that are not timed, by name, drawn by processes of the pool."""
    found: dict[str, Future[Summary]] = {}
    with pool() as executor:
        for name, study in ((name, load_study(name)) for name in studies):
            if not study.timed:
                rows = run_study(study, folder / name, _shared(pool))
                found[name] = executor.submit(summarise_study, folder, name, study, rows)
        return {name: one.result() for name, one in found.items()}


def _of_paper(solved: Solved, snapshots: SnapshotsSection, untimed: _Untimed) -> Page:
    """Return the page of the paper's figures, of rock masses and of the hard cases."""
    paper, others = solved.split(lambda section: section.request.number is not None)
    return replace(
        _page(paper, PAPERS, "jointwave report --out DIR"),
        about=mostly_dispersion(solved.comparisons[FREE_PILLAR][0]),
        snapshots=snapshots,
        rock_masses=RockMasses(Overview(_ranked(others)), others.sections, untimed.joints),
        stability=untimed.stability,
    )


def _page(solved: Solved, subtitle: str, command: str) -> Page:
    sections = solved.sections
    return Page(
        subtitle,
        Overview(_ranked(solved)),
        tables.summary_table({s.request.label: solved.comparisons[s.name] for s in sections}),
        sections,
        command,
        measured_on(),
        versions(solved.comparisons.values()),
    )


def _ranked(solved: Solved) -> list[RankedScene]:
    """Return where engines stand on each scene, and what a run of theirs takes, timed alone."""
    with alone():
        taken = {name: seconds(variants[0]) for name, variants in solved.comparisons.items()}
    return [
        RankedScene(s.name, s.request.label, s.title, s.standings, taken[s.name])
        for s in solved.sections
    ]


def _with_measured(
    page: Page,
    out: Path,
    studies: tuple[str, ...],
    untimed: _Untimed,
    others: DataFrame | None,
    pool: Pool,
    part: Callable[[str], Progress],
) -> Page:
    """Return the page with what was measured: the seconds after everything else, and alone; drawn
    once no more are to be measured."""
    kept = out / "effects"
    timed = tuple(name for name in studies if name not in untimed.studies)
    measured = reported_studies(out, timed, part("studies"), _shared(pool))
    effects = ablation_runs.run(ablation_runs.reported(), kept, _shared(pool), part("effects"))
    with pool() as executor:
        submitted = [executor.submit(summarise_study, *one) for one in measured]
        drawn = dict(zip(timed, submitted, strict=True))
        of_effects = executor.submit(summarise_ablation, kept, effects)
        section = None if others is None else peers.write_section(out / "studies", others)
        return replace(
            page,
            studies=[untimed.studies.get(x) or drawn[x].result() for x in studies],
            effects=of_effects.result(),
            peers=section,
            peers_file=str(peers.PLACE),
        )
