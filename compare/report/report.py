"""The report: the figures of Guo & Li (2002), or scenes of one's own, as one page."""

import shlex
from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from pandas import DataFrame

from compare.engines import Progress
from compare.experiments.ablation import runner as ablation_runs
from compare.experiments.ablation.summary import summarise as summarise_ablation
from compare.experiments.cost.timings import measured_on
from compare.experiments.pool import Lent, Pool, alone
from compare.experiments.robustness.summary import make_study as make_hard_cases
from compare.experiments.scattering import summary as scattering
from compare.experiments.study.summary import REPORTED
from compare.experiments.study.summary import reported as reported_studies
from compare.figures.charts.static import draw
from compare.figures.charts.waveforms import by_solutions
from compare.figures.export import save
from compare.figures.subplots import curve_table
from compare.misfit.pairs import Comparison
from compare.report import peers, tables
from compare.report.cost import seconds
from compare.report.findings.overview import mostly_dispersion
from compare.report.overview import Overview, RankedScene
from compare.report.reading_table import reading_frame
from compare.report.render import Page, RockMasses, render
from compare.report.scenes import ROCK_MASSES, Solved, asked_for, solve
from compare.report.snapshots import make_snapshots
from compare.report.versions import versions
from compare.runs.output import write_csv, write_text
from compare.runs.workers import Workers

FREE_PILLAR = "fig-03"  # the scene that says what the paper's own comparison is made of
#: From which to which fraction of the paper's page each part takes, where kernels are compiled.
PARTS = {
    "scenes": (0.0, 0.6),
    "hard cases": (0.6, 0.7),
    "studies": (0.7, 0.88),
    "rock masses": (0.88, 0.95),
    "effects": (0.95, 1.0),
}
PAPERS = (
    "Figures 2 to 10 of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124–1129, by rigid "
    "blocks, by a deformable continuum and by exact solutions"
)


class Report(NamedTuple):
    """The HTML file of the report, and what stands on its page."""

    file: Path
    page: Page


def build(
    out: Path,
    progress: Progress | None = None,
    workers: int = 2,
    scenes: Sequence[str] = (),
    studies: tuple[str, ...] = REPORTED,
    peers_table: Path | None = None,
    hard: bool = True,
) -> Report:
    """Solve scenes by all that applies, and write their figures, tables and `out`/index.html.

    `scenes` are files or names of shipped ones; without any, the page has the paper's figures and
    after them the studies. `progress` is called with the finished fraction of the whole.
    `peers_table` is what `make bench-peers` wrote; None: where it writes, if it did.
    `hard` : also put both engines to the hard cases, except those that take long.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    with Workers(workers) as executor:
        pool = partial(Lent, executor)
        if scenes:
            page = _of_scenes(Path(out), scenes, progress, pool)
        else:
            others = peers.read(peers_table)
            page = _of_paper(Path(out), _part(progress, "scenes"), pool)
            page = _with_hard_cases(page, Path(out), pool, progress) if hard else page
            page = _with_studies(page, Path(out), studies, others, pool, progress)
            page = _with_joints(page, Path(out), pool, progress)
            page = _with_effects(page, Path(out), pool, progress)
    return Report(write_text(Path(out) / "index.html", render(page, Path(out))), page)


def _part(progress: Progress | None, name: str) -> Progress | None:
    """Return what is told the progress of one part of the paper's page."""
    if progress is None:
        return None
    start, end = PARTS[name]
    return lambda fraction: progress(start + (end - start) * fraction)


def _of_scenes(out: Path, scenes: Sequence[str], progress: Progress | None, pool: Pool) -> Page:
    """Return the page of some scenes alone."""
    solved = solve(out / "figures", asked_for(scenes), progress, pool)
    count = len(solved.sections)
    about = solved.sections[0].title if count == 1 else f"{count} scenes"
    return _page(solved, about, shlex.join(["jointwave", "report", *scenes, "--out", "DIR"]))


def _of_paper(out: Path, progress: Progress | None, pool: Pool) -> Page:
    """Return the page of the paper's figures."""
    snapshots: list[Future] = []

    def besides(executor: Executor) -> list[Future]:
        snapshots.append(executor.submit(make_snapshots, out))
        return snapshots

    asked = [*asked_for(()), *asked_for(ROCK_MASSES)]
    solved = solve(out / "figures", asked, progress, pool, besides)
    paper, others = solved.split(lambda section: section.request.number is not None)
    page = _page(paper, PAPERS, "jointwave report --out DIR")
    rock_masses = RockMasses(Overview(_ranked(others)), others.sections, [])
    about = mostly_dispersion(solved.comparisons[FREE_PILLAR][0])
    return replace(page, about=about, snapshots=snapshots[0].result(), rock_masses=rock_masses)


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


def _with_hard_cases(page: Page, out: Path, pool: Pool, progress: Progress | None) -> Page:
    part = _part(progress, "hard cases")
    return replace(page, stability=make_hard_cases(out / "studies", pool, False, part))


def _with_joints(page: Page, out: Path, pool: Pool, progress: Progress | None) -> Page:
    """Return the page with what joints reflect and pass."""
    part, names = _part(progress, "rock masses"), list(scattering.TITLES)
    found = []
    for i, name in enumerate(names):
        found.append(scattering.make_study(name, out / "studies", brief=True, pool=pool))
        if part:
            part((i + 1) / len(names))
    assert page.rock_masses
    return replace(page, rock_masses=page.rock_masses._replace(studies=found))


def _with_studies(
    page: Page,
    out: Path,
    studies: tuple[str, ...],
    others: DataFrame | None,
    pool: Pool,
    progress: Progress | None,
) -> Page:
    """Return the page with what was measured: the seconds after everything else, and alone."""
    return replace(
        page,
        studies=reported_studies(out, studies, _part(progress, "studies"), pool),
        peers=None if others is None else peers.write_section(out / "studies", others),
        peers_file=str(peers.PLACE),
    )


def _with_effects(page: Page, out: Path, pool: Pool, progress: Progress | None) -> Page:
    effects = ablation_runs.run(
        ablation_runs.reported(), out / "effects", pool, _part(progress, "effects")
    )
    return replace(page, effects=summarise_ablation(out / "effects", effects))


def write_comparisons(comparisons: list[Comparison], out: Path) -> None:
    """Write the figure, the curves, the distances and what is read off one scene's variants into a
    folder.

    With curves of others also how they were aligned, as comparison-alignment.csv.
    """
    folder, name = Path(out), "comparison"
    curves = curve_table(comparisons).reset_index()
    save(draw(name, by_solutions(comparisons)), folder, name, comparisons[0].scene.title, curves)
    write_csv(folder / f"{name}-misfits.csv", tables.distance_frame(comparisons))
    if not (read := reading_frame(comparisons)).empty:
        write_csv(folder / f"{name}-readings.csv", read)
    if any(comparison.besides for comparison in comparisons):
        write_csv(folder / f"{name}-alignment.csv", tables.alignment_frame(comparisons))
