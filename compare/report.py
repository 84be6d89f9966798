"""The report: the figures of Guo & Li (2002) by everything that can solve them, as one page."""

from collections.abc import Iterable
from concurrent.futures import Future, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import cases
from cases.result import scene_hash
from cases.scene import Scene
from compare import peers, rates, tables, worth_section, worth_study
from compare.engines import Progress
from compare.findings import Finding
from compare.findings.overview import mostly_dispersion
from compare.output import write, write_text
from compare.page import Motion, Section, make_motion, make_section, render, write_figure
from compare.pairs import Comparison, compare
from compare.stability.section import make_section as make_hard_section
from compare.studies.section import REPORTED, make_sections, measured_on
from compare.workers import Workers

SCENES = Path(cases.__file__).parent / "guo-li-2002"

RATE = "figure of the report"  # what the seconds of figures are remembered by
FREE_PILLAR = "fig-03"  # the scene that the overview is about


@dataclass(frozen=True)
class Report:
    """What the report says in short.

    page : the HTML file. summary : largest misfit in % by pair and figure. overview : what the
    distance to the homogenised bar is made of; None without the free pillar's scene. findings : by
    number of the figure. seconds : it took.
    """

    page: Path
    summary: tables.Table
    overview: Finding | None
    findings: dict[int, list[Finding]]
    seconds: float

    @property
    def columns(self) -> list[str]:
        """The summary's columns: kind of distance, pair, then the figures."""
        return ["what", *self.summary.header]

    @property
    def rows(self) -> list[list[str]]:
        """The summary's rows, in %."""
        return [[kind, *row] for kind, rows in self.summary.groups.items() for row in rows]


def build(
    out: Path,
    progress: Progress | None = None,
    workers: int = 2,
    scenes: Path = SCENES,
    studies: tuple[str, ...] = REPORTED,
    peers_table: Path | None = None,
    hard: bool = True,
) -> Report:
    """Solve the scene of every figure, run the studies, and write figures, CSV tables and
    `out`/index.html.

    `progress` is called with the finished fraction; `scenes` is a folder of fig-NN.toml.
    `peers_table` is what `make bench-peers` wrote; None: where it writes, if it did.
    `hard` : also put both engines to the hard cases, except those that take long.
    Raises SceneError and UnstableError, as `compare` does; the page is then not written.
    """
    began = perf_counter()
    others = peers.read(peers_table)
    files = sorted(scenes.glob("fig-*.toml"))
    with rates.timing(RATE, len(files)):
        sections, figures, motion = _compute(Path(out), files, progress, workers)
    overview, free = None, None
    if FREE_PILLAR in figures:
        overview = mostly_dispersion(figures[FREE_PILLAR][0])
        free = tables.misfit_table(figures[FREE_PILLAR])
    summary = tables.summary_table({f"fig. {s.number}": figures[s.name] for s in sections})
    stability = None
    if hard:
        stability = make_hard_section(Path(out), lambda: Workers(workers))
    # Seconds count: after everything else, and alone.
    measured = make_sections(Path(out), studies)
    balances = worth_study.complete(worth_study.reported(), Path(out) / "effects")
    html = render(
        sections,
        figures,
        overview=overview,
        free=free,
        summary=summary,
        motion=motion,
        studies=measured,
        stability=stability,
        effects=worth_section.write_section(Path(out) / "effects", balances),
        peers=None if others is None else peers.write_section(Path(out) / "studies", others),
        peers_file=peers.PLACE,
        machine=measured_on(),
    )
    page = write_text(Path(out) / "index.html", html)
    found = {section.number: section.findings for section in sections}
    return Report(page, summary, overview, found, perf_counter() - began)


def write_comparisons(comparisons: list[Comparison], out: Path) -> None:
    """Write the figure, the curves and the distances of one scene's variants into a folder.

    With curves of others also how they were aligned, as comparison-alignment.csv.
    """
    write_figure(Path(out), "comparison", comparisons)
    if any(comparison.besides for comparison in comparisons):
        frame = tables.alignment_frame(comparisons)
        file = Path(out) / "comparison-alignment.csv"
        write(file, lambda path: frame.to_csv(path, float_format="%.9g", index=False))


def _compute(
    out: Path, files: list[Path], progress: Progress | None, workers: int
) -> tuple[list[Section], dict[str, list[Comparison]], Motion]:
    """Solve and draw in processes of their own; return sections, comparisons by file, and what
    moves."""
    loaded = {file: cases.load(file) for file in files}
    unique = {_key(scene): scene for variants in loaded.values() for scene in variants}
    kept = out / "effects"
    weighed = worth_study.unprepared(worth_study.reported(), kept)
    jobs, done = len(unique) + len(files) + 1, 0

    def finish(futures: Iterable[Future]) -> None:
        nonlocal done
        for future in as_completed(futures):
            future.result()
            done += 1
            if progress:
                progress(done / jobs)

    with Workers(workers) as pool:
        weighing = worth_study.submit(pool, weighed, kept)
        jobs += len(weighing)
        order = _longest_first(unique)
        solved = {key: pool.submit(compare, unique[key], None, True) for key in order}
        moving = pool.submit(make_motion, out)
        finish([*solved.values(), moving, *weighing])
        figures = {
            file: [replace(solved[_key(scene)].result(), scene=scene) for scene in variants]
            for file, variants in loaded.items()
        }
        drawn = [
            pool.submit(make_section, out / "figures", file, comparisons)
            for file, comparisons in figures.items()
        ]
        finish(drawn)
    sections = [future.result() for future in drawn]
    return sections, {f.stem: c for f, c in figures.items()}, moving.result()


def _key(scene: Scene) -> str:
    """Return what decides a scene's results: its hash without names and bounds."""
    unnamed = scene.model_copy(update={"title": "", "source": None, "name": "", "expect": {}})
    return scene_hash(unnamed)


def _longest_first(scenes: dict[str, Scene]) -> list[str]:
    """Return the keys in order of cost, the most damped first: dashpots shorten the step."""
    return sorted(scenes, key=lambda key: -(scenes[key].joints.damping_ratio or 0.0))
