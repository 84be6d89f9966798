"""The scenes of a report: which, by what name, and all of them solved and drawn in processes."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass, replace
from pathlib import Path

import xarray as xr

from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.schema.scene import Scene
from compare.engines import Progress
from compare.experiments.cost import timings
from compare.figures.scene_figures import along_pillar, figures_of, recorded_along
from compare.misfit.pairs import Comparison
from compare.report.section import PAPER, SceneRequest, Section, begin, finish, make_section
from compare.runs.comparison import compare
from compare.scenes import find, load
from compare.studies.ensemble import ensemble_in
from results.dataset import scene_hash

#: The shipped scenes of rock masses that the page shows beside the paper's figures.
ROCK_MASSES = ("rock-mass/one-joint",)
RATE = "scene of the report"  # what the seconds of scenes are remembered by
TAKEN = {"", "overview", "made", "said", "rock-masses"}  # what the page calls its own parts
#: From which to which fraction of the progress scenes are solved, and drawn.
SOLVED, DRAWN = (0.0, 0.5), (0.5, 1.0)
Pool = Callable[[], Executor]
Submit = Callable[[Executor], list[Future]]


@dataclass
class Solved:
    """What the scenes have come to, by name and in the page's order."""

    comparisons: dict[str, list[Comparison]]
    sections: list[Section]

    def split(self, chosen: Callable[[Section], bool]) -> tuple[Solved, Solved]:
        """Return what the chosen scenes have come to, and all others."""
        return self._of(chosen), self._of(lambda section: not chosen(section))

    def _of(self, chosen: Callable[[Section], bool]) -> Solved:
        sections = [section for section in self.sections if chosen(section)]
        return Solved({s.name: self.comparisons[s.name] for s in sections}, sections)


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


def solve(
    folder: Path,
    asked: list[SceneRequest],
    progress: Progress | None,
    pool: Pool,
    besides: Submit = lambda executor: [],
    begin_others: Callable[[], None] = lambda: None,
) -> Solved:
    """Solve and draw scenes by the processes of a pool; pictures and tables go to `folder`.

    Each variant is solved once, however many scenes share it. `besides` submits what else is to be
    done at the same time; `begin_others` is called once nothing is left to be submitted.
    """
    loaded = {one.name: load(one.file) for one in asked}
    unique = {_key(scene): scene for variants in loaded.values() for scene in variants}
    tell = _teller(progress)
    with timings.timing(RATE, len(asked)), pool() as executor:
        order = sorted(unique, key=lambda key: _rank(unique[key]))
        wide = {_along(unique[key]): key for key in reversed(order)}
        found = {key: executor.submit(_solved, unique[key], key in wide.values()) for key in order}
        tell([*found.values(), *besides(executor)], SOLVED)
        comparisons = {
            name: [replace(found[_key(scene)].result()[0], scene=scene) for scene in variants]
            for name, variants in loaded.items()
        }
        fields = {
            name: [found[wide[_along(scene)]].result()[1] for scene in variants]
            for name, variants in loaded.items()
        }
        pictures = (
            (one, picture)
            for one in asked
            for picture in (
                *figures_of(one.name, comparisons[one.name], fields[one.name]),
                *(replace(b, name=f"{one.name}-{b.name}") for b in one.besides),
            )
        )
        begun = begin(folder, pictures, executor)
        begin_others()
        tell([files for some in begun.values() for _, files in some if files], DRAWN)
    sections = [make_section(folder, a, comparisons[a.name], finish(begun[a.name])) for a in asked]
    return Solved(comparisons, sections)


def _solved(scene: AnyScene, along: bool) -> tuple[Comparison, dict[str, xr.Dataset]]:
    """Return the solutions of a scene, and, if wanted, those all along its pillar."""
    return compare(scene, None, True), along_pillar(scene) if along else {}


def _teller(progress: Progress | None) -> Callable[[list[Future], tuple[float, float]], None]:
    """Return what waits for futures, and tells the progress of them within a part of the whole."""

    def wait(futures: list[Future], part: tuple[float, float]) -> None:
        for done, future in enumerate(as_completed(futures), start=1):
            future.result()
            if progress:
                progress(part[0] + (part[1] - part[0]) * done / len(futures))

    return wait


def _key(scene: AnyScene) -> str:
    """Return what decides a scene's results: its hash without names and bounds."""
    unnamed = scene.model_copy(update={"title": "", "source": None, "name": "", "expect": {}})
    return scene_hash(unnamed)


def _along(scene: AnyScene) -> str:
    """Return what decides a scene's results all along its pillar."""
    return _key(recorded_along(scene))


def _rank(scene: AnyScene) -> tuple[bool, float]:
    """Return the place of a scene in the order of cost, the dearest first: rock masses, and joints
    that open; then the most damped, since dashpots shorten the step."""
    if not isinstance(scene, Scene):
        return False, 0.0
    return scene.joints.tension is not False, -(scene.joints.damping_ratio or 0.0)
