"""The scenes of a report: their selection, names, solutions, figures and tables."""

import json
import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from jointwave import cases
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, label_of
from jointwave.compare.figures import scene_figures, tables
from jointwave.compare.figures.export import Drawn, SceneFigure, save
from jointwave.compare.figures.receivers import panels
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.report.claims import CLAIMS, Claim, joints, pillar, travel  # noqa: F401 (add theirs)
from jointwave.compare.report.verdict import NOT_CHECKED, EngineScore, engine_scores, verdict_table
from jointwave.compare.runs import timings
from jointwave.compare.runs.comparison import compare
from jointwave.compare.runs.output import write_csv
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder, seconds_read
from jointwave.compare.scenes import find, load_variants
from jointwave.compare.studies.forecast import Run, runs_of
from jointwave.compare.text import in_seconds, percent, span, times

PAPER = Path(cases.__file__).parent / "guo-li-2002"
FREE_PILLAR = 3  # number of the figure whose misfit is explained, see `about`
#: The shipped scenes of rock masses that follow the paper's figures on the page.
ROCK_MASSES = ("rock-mass/one-joint",)
FEW = 2  # largest number of references listed by name
CLOSE = 0.2  # largest misfit worded "within", not "up to"
TAKEN = {"", "overview", "made", "rock-masses", "peers", "effects", "stability", "motion", "film"}


class SceneRequest(NamedTuple):
    """A scene of the report: its file, the name given by the user, and its name on the page."""

    file: Path
    called: str
    name: str

    @property
    def number(self) -> int | None:
        """The number of the paper's figure; None for any other scene."""
        found = re.fullmatch(r"fig-(\d+)", self.file.stem)
        return int(found[1]) if found and self.file.resolve().parent == PAPER.resolve() else None

    @property
    def label(self) -> str:
        """Its name in columns and links."""
        return f"fig. {self.number}" if self.number else self.name

    def own(self, stored: ResultFolder) -> ResultFolder:
        """Return the folder of its results, a subfolder of `stored`."""
        return replace(stored, folder=stored.folder and stored.folder / self.file.stem)


class SolvedScene(NamedTuple):
    """A scene solved with all solvers that apply.

    scene : the first variant solved by most engines. seconds : of stepping it, by engine; of
    another variant if an engine does not solve it. lead : the picture at the head, None without
    receivers. tables, files : by name; some tables are also files. scores : verdicts of its
    engines. worst : misfits by pair. versions : of packages. about : parts of the misfit of the
    paper's free pillar. read : computing times of the results that were read, s.
    """

    request: SceneRequest
    scene: AnyScene
    seconds: dict[str, float]
    lead: Drawn | None
    figures: list[Drawn]
    claims: list[Claim]
    tables: dict[str, pd.DataFrame]
    files: dict[str, Path]
    scores: dict[str, EngineScore]
    worst: pd.Series
    versions: dict[str, str]
    about: Claim | None = None
    read: Sequence[float] = ()

    @property
    def costs(self) -> dict[str, float]:
        """The seconds of each engine over those of the cheapest engine."""
        least = min(self.seconds.values())
        return {name: s / least if least > 0 else 1.0 for name, s in self.seconds.items()}

    @property
    def link(self) -> str:
        """Its entry in the contents."""
        return f"{self.request.number or ''} {self.scene.title}".strip()

    @property
    def command(self) -> str:
        """The command that reports this scene alone."""
        return shlex.join(["jointwave", "report", self.request.called, "--out", self.request.name])


def asked_for(scenes: Sequence[str]) -> list[SceneRequest]:
    """Return the scenes to report, with unique names; if none are given, the paper's."""
    paper = [f"{PAPER.name}/{file.stem}" for file in sorted(PAPER.glob("fig-*.toml"))]
    called = list(dict.fromkeys(scenes)) or paper
    found: dict[str, SceneRequest] = {}
    for one in called:
        file = find(one)
        stem = re.sub(r"[^A-Za-z0-9_-]+", "-", file.stem).strip("-")
        names = [stem, *(f"{stem or 'scene'}-{k}" for k in range(2, len(called) + 3))]
        name = next(n for n in names if n not in found and n not in TAKEN)
        found[name] = SceneRequest(file, one, name)
    return list(found.values())


def planned(request: SceneRequest, stored: ResultFolder) -> list[Run]:
    """Return the runs of `solve`."""
    own, found = request.own(stored), []
    for scene in load_variants(request.file):
        found += runs_of(applicable(scene), scene, own, point=request.label)
        found += runs_of(*scene_figures.runs_along(scene), own, scene_figures.ALONG, request.label)
    return found


def solve(request: SceneRequest, folder: Path, stored: ResultFolder = NOWHERE) -> SolvedScene:
    """Solve a scene's variants with all solvers that apply; write its figures and tables.

    stored : folder with a folder of results for each scene.
    """
    own, scenes = request.own(stored), load_variants(request.file)
    comparisons = [compare(scene, spectral=True, stored=own) for scene in scenes]
    scores = engine_scores(comparisons)
    timed = max(comparisons, key=lambda one: len(scores.keys() & one.results.keys()))
    results = {**{k: x for one in comparisons for k, x in one.results.items()}, **timed.results}
    readings = tables.reading_frame(comparisons)
    frames = {"misfits": tables.distance_frame(comparisons), "readings": readings}
    paths = {name: folder / f"{request.name}-{name}.csv" for name in frames if len(frames[name])}
    versions = [json.loads(result.attrs.get("versions", "{}")) for result in results.values()]
    return SolvedScene(
        request,
        timed.scene,
        {engine: float(results[engine].attrs["seconds_stepping"]) for engine in scores},
        *_draw(request, comparisons, folder, own),
        [measure(comparisons) for measure in CLAIMS.get(request.number or 0, [])],
        {
            "verdicts": verdict_table(scores),
            "misfits": tables.misfit_table(comparisons),
            "distances": tables.distance_table(comparisons),
            "readings": readings,
            "runs": tables.run_table(comparisons),
            "reasons": tables.reason_table(comparisons),
        },
        {name: write_csv(path, frames[name]) for name, path in paths.items()},
        scores,
        tables.worst_misfits(comparisons),
        {name: number for one in versions for name, number in one.items()},
        pillar.mostly_dispersion(comparisons) if request.number == FREE_PILLAR else None,
        [s for one in comparisons for s in seconds_read(one.results)],
    )


def _draw(
    request: SceneRequest, comparisons: list[Comparison], folder: Path, stored: ResultFolder
) -> tuple[Drawn | None, list[Drawn]]:
    """Return the picture at the head (a map, else the waveform of the first variant that is
    furthest from its reference), and all figures."""
    fields = [scene_figures.along_pillar(one.scene, stored) for one in comparisons]
    with timings.measured("pages", comparisons[0].scene.kind, len(comparisons)):
        figures = scene_figures.figures_of(request.name, comparisons, fields)
        shown = {one.name: _save(one, folder) for one in figures}
        lead = shown.get(f"{request.name}-peak-velocity-0")
        if lead is None and (moving := panels(comparisons)[0]):
            panel = max(moving, key=lambda one: one.largest_residual)
            lead = _save(scene_figures.lead_figure(request.name, panel), folder)
    return lead, list(shown.values())


def _save(one: SceneFigure, folder: Path) -> Drawn:
    drawn = save(one.figure, folder, one.name, one.title, one.table, png=False)
    return drawn._replace(caption=one.caption, folded=one.folded)


def lead(scenes: Sequence[SolvedScene]) -> dict[str, str]:
    """Return a sentence on each engine that solves any of the scenes."""
    found = {e: [one for one in scenes if e in one.scores] for e in ENGINES}
    return {engine: _sentence(engine, solved) for engine, solved in found.items() if solved}


def _sentence(engine: str, scenes: list[SolvedScene]) -> str:
    """Return an engine's misfit from the finest physics by kind of scene, and its cost."""
    kinds = dict.fromkeys(one.scene.kind for one in scenes)
    of_kind = {kind: [one for one in scenes if one.scene.kind == kind] for kind in kinds}
    apart = [
        _distance(engine, some, f" for the {kind}{'s' * (len(some) > 1)}" * (len(kinds) > 1))
        for kind, some in of_kind.items()
    ]
    costs = [one.costs[engine] for one in scenes]
    cost = f"{span(costs, times)} the time of the cheapest"
    if max(costs) == 1:
        cost = f"the cheapest: {span((one.seconds[engine] for one in scenes), in_seconds)} a run"
    return f"{ENGINES[engine].sentence} {' and '.join(apart)}; {cost}."


def _distance(engine: str, scenes: list[SolvedScene], of: str) -> str:
    """Return the largest misfit from the references as text; of : words for the scenes."""
    scores = [one.scores[engine] for one in scenes]
    found = [x for one in scores if not isnan(x := one.total.judged)]
    if not found:
        return NOT_CHECKED.word + of
    against = dict.fromkeys(v.against for one in scores for v in one.variants if v.against)
    names = (re.sub("(.*), exact", r"the exact \1", label_of(name)) for name in against)
    whom = " or ".join(names) if len(against) <= FEW else "the finest physics"
    apart = percent(max(found), 2).removeprefix("< ")
    close = max(found) <= CLOSE
    said = f"within {apart} % of {whom}" if close else f"up to {apart} % from {whom}"
    unchecked = sum(bool(one.unchecked) for one in scores)
    return f"{said}{of}" + f" ({unchecked} of {len(scenes)} {NOT_CHECKED.word})" * bool(unchecked)
