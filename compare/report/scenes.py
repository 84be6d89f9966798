"""The scenes of a report: which, by what name, and all of them solved and drawn in processes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, Future, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cases.schema.scene import Scene
from compare.engines import Progress
from compare.experiments.cost import timings
from compare.experiments.pool import Pool
from compare.figures.charts.along_axis import along_pillar, recorded_along
from compare.misfit.pairs import Comparison, compare
from compare.report.section import PAPER, SceneRequest, Section, linked, make_section
from compare.scenes import find, load
from results.dataset import scene_hash

if TYPE_CHECKING:
    from cases.kinds import AnyScene

#: The shipped scenes of rock masses that the page shows beside the paper's figures.
ROCK_MASSES = ("rock-mass/one-joint",)
RATE = "scene of the report"  # what the seconds of scenes are remembered by
TAKEN = {"", "overview", "made", "said", "rock-masses"}  # what the page calls its own parts
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


def asked_for(scenes: Sequence[str]) -> list[SceneRequest]:
    """Return the scenes to report, each under a name of its own; without any, the paper's."""
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


def solve(
    folder: Path,
    asked: list[SceneRequest],
    progress: Progress | None,
    pool: Pool,
    besides: Submit = lambda executor: [],
) -> Solved:
    """Solve and draw scenes by the processes of a pool; pictures and tables go to `folder`.

    Each variant is solved once, however many scenes share it. `besides` submits what else is to be
    done at the same time.
    """
    loaded = {one.name: load(one.file) for one in asked}
    unique = {_key(scene): scene for variants in loaded.values() for scene in variants}
    with timings.timing(RATE, len(asked)), pool() as executor:
        order = _longest_first(unique)
        found = {key: executor.submit(compare, unique[key], None, True) for key in order}
        wide = {_along(scene): scene for variants in loaded.values() for scene in variants}
        along = {key: executor.submit(along_pillar, scene) for key, scene in wide.items()}
        tell = _counted(
            [*found.values(), *along.values(), *besides(executor)], len(asked), progress
        )
        comparisons = {
            name: [replace(found[_key(scene)].result(), scene=scene) for scene in variants]
            for name, variants in loaded.items()
        }
        fields = {
            name: [along[_along(scene)].result() for scene in variants]
            for name, variants in loaded.items()
        }
        drawn = [
            executor.submit(make_section, folder, a, comparisons[a.name], fields[a.name])
            for a in asked
        ]
        tell(drawn)
    return Solved(comparisons, linked([future.result() for future in drawn]))


def _counted(
    first: list[Future], more: int, progress: Progress | None
) -> Callable[[Iterable[Future]], None]:
    """Wait for the first futures; return what waits for as many more. Both tell the progress."""
    done, jobs = 0, len(first) + more

    def finish(futures: Iterable[Future]) -> None:
        nonlocal done
        for future in as_completed(futures):
            future.result()
            done += 1
            if progress:
                progress(done / jobs)

    finish(first)
    return finish


def _key(scene: AnyScene) -> str:
    """Return what decides a scene's results: its hash without names and bounds."""
    unnamed = scene.model_copy(update={"title": "", "source": None, "name": "", "expect": {}})
    return scene_hash(unnamed)


def _along(scene: AnyScene) -> str:
    """Return what decides a scene's results all along its pillar."""
    return _key(recorded_along(scene))


def _longest_first(scenes: dict[str, AnyScene]) -> list[str]:
    """Return the keys in order of cost, the most damped first: dashpots shorten the step."""
    return sorted(scenes, key=lambda key: -_damping(scenes[key]))


def _damping(scene: AnyScene) -> float:
    """Return the largest damping ratio of a scene's joints."""
    laws = [scene.joints] if isinstance(scene, Scene) else scene.joint_sets
    return max((one.damping_ratio or 0.0 for one in laws), default=0.0)
