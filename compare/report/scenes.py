"""The scenes of a report: which, by what name, and each of them solved and drawn."""

import json
import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.figures.export import Drawn, save
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.scene_figures import along_pillar, figures_of
from jointwave.compare.figures.tables import distance_frame, reading_frame
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report import tables
from jointwave.compare.report.claims import claims_of
from jointwave.compare.report.claims.claim import Claim
from jointwave.compare.report.claims.pillar import mostly_dispersion
from jointwave.compare.report.verdict import EngineScore, engine_scores
from jointwave.compare.runs.comparison import compare
from jointwave.compare.runs.output import write_csv
from jointwave.compare.scenes import find, load
from jointwave.compare.studies.ensemble import ensemble_in

PAPER = Path(cases.__file__).parent / "guo-li-2002"
FREE_PILLAR = 3  # the figure that says what the paper's own comparison is made of
#: The shipped scenes of rock masses that the page shows beside the paper's figures.
ROCK_MASSES = ("rock-mass/one-joint",)
TAKEN = {"", "overview", "made", "rock-masses", "peers", "effects", "stability", "motion"}


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
    """A picture as it stands on the page; folded : whether it stands in a fold."""

    drawn: Drawn
    caption: str
    folded: bool


class SolvedScene(NamedTuple):
    """A scene solved by all that applies.

    section : what its section of the page shows. scores : where its engines stand. worst : misfits
    by pair. scene : its first variant, and the seconds of stepping it by engine. versions : of the
    packages that solved it. about : what its misfit is made of, of the paper's free pillar.
    """

    request: SceneRequest
    title: str
    figures: list[Shown]
    claims: list[Claim]
    section: dict[str, Any]
    scores: dict[str, EngineScore]
    worst: pd.Series
    scene: AnyScene
    seconds: dict[str, float]
    versions: dict[str, str]
    about: Claim | None


def asked_for(scenes: Sequence[str], ensembles: Sequence[Path] = ()) -> list[SceneRequest]:
    """Return the scenes to report, each under a name of its own; without any, the paper's.

    ensembles : folders of ensembles of these scenes; raises SceneError where one is of another.
    """
    paper = [f"{PAPER.name}/{file.stem}" for file in sorted(PAPER.glob("fig-*.toml"))]
    called = list(dict.fromkeys(scenes)) or paper
    found: dict[str, SceneRequest] = {}
    for one in called:
        file = find(one)
        stem = re.sub(r"[^A-Za-z0-9_-]+", "-", file.stem).strip("-")
        names = [stem, *(f"{stem or 'scene'}-{k}" for k in range(2, len(called) + 3))]
        name = next(n for n in names if n not in found and n not in TAKEN)
        found[name] = SceneRequest(file, one, name)
    for folder in ensembles:
        scene, figures = ensemble_in(folder)
        name = next((n for n, one in found.items() if one.file.resolve() == scene.resolve()), "")
        if not name:
            raise SceneError("--ensemble", str(folder), None, f"is of {scene}: name that, too")
        found[name] = found[name]._replace(besides=(*found[name].besides, *figures))
    return list(found.values())


def solve(request: SceneRequest, folder: Path) -> SolvedScene:
    """Solve a scene's variants by all that applies, and write its pictures and tables."""
    comparisons = [compare(scene, None, True) for scene in load(request.file)]
    first, scores = comparisons[0], engine_scores(comparisons)
    versions: dict[str, str] = {}
    for result in first.results.values():
        versions |= json.loads(result.attrs.get("versions", "{}"))
    return SolvedScene(
        request,
        first.scene.title,
        _draw(request, comparisons, folder),
        claims_of(request.number, comparisons),
        _section(request, comparisons, scores, folder),
        scores,
        tables.worst_misfits(comparisons),
        first.scene,
        {engine: float(first.results[engine].attrs["seconds_stepping"]) for engine in scores},
        versions,
        mostly_dispersion(first) if request.number == FREE_PILLAR else None,
    )


def _draw(request: SceneRequest, comparisons: list[Comparison], folder: Path) -> list[Shown]:
    fields = [along_pillar(one.scene) for one in comparisons]
    besides = [replace(one, name=f"{request.name}-{one.name}") for one in request.besides]
    return [
        Shown(save(p.figure, folder, p.name, p.title, p.table, png=False), p.caption, p.folded)
        for p in (*figures_of(request.name, comparisons, fields), *besides)
    ]


def _section(
    request: SceneRequest,
    comparisons: list[Comparison],
    scores: dict[str, EngineScore],
    folder: Path,
) -> dict[str, Any]:
    """Return what the section shows beside pictures and claims; write its tables."""
    scene, readings = comparisons[0].scene, reading_frame(comparisons)
    misfits = write_csv(folder / f"{request.name}-misfits.csv", distance_frame(comparisons))
    found: dict[str, Any] = {
        "heading": f"Figure {request.number}. {scene.title}" if request.number else scene.title,
        "source": scene.source or "",
        "command": shlex.join(["jointwave", "report", request.called, "--out", request.name]),
        "verdicts": tables.verdict_table(scores),
        "misfits": tables.misfit_table(comparisons),
        "distances": tables.distance_table(comparisons),
        "distances_file": misfits,
        "runs": tables.run_table(comparisons),
        "reasons": tables.reason_table(comparisons),
        "toml": request.file.read_text(encoding="utf-8-sig"),
    }
    if len(readings):
        found["readings_file"] = write_csv(folder / f"{request.name}-readings.csv", readings)
        found["readings"] = readings.set_index(["variant", "solution", "at"])
    return found
