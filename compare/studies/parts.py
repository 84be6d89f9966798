"""The runs of a study, of effects and of the report that are not done, for `--dry-run`."""

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import effects, hard_cases, scattering, work_precision
from jointwave.compare.studies.forecast import Run, all_runs
from jointwave.compare.studies.store import Store
from jointwave.compare.studies.study import load

#: Its part of the command, its key in the store, what reads its scene, and the solvers that run it.
Point = tuple[str, str, Callable[[], AnyScene], list[str]]


def of_study(name: str, out: Path, brief: bool = False) -> list[Run]:
    """Return the runs of a study by its curves; brief : of waves at joints, as the report has."""
    points: list[Point]
    if name == hard_cases.NAME:
        found = hard_cases.hard_cases()
        points = [("hard cases", hard_cases.key(x), x.read, [x.engine]) for x in found]
    elif name in scattering.SOLVERS:
        points = [
            (name, scattering.key(x), partial(scattering.scene_of, *x[1:]), [x.solver])
            for x in scattering.points(name, brief)
        ]
    else:
        points = [
            (
                f"{Path(name).stem}: {x.curve.label} ({x.curve.method})",
                work_precision.key(x),
                partial(getattr, x, "scene"),
                [x.curve.method],
            )
            for x in load(name).points()
        ]
    return _to_do(points, out / Path(name).stem)


def of_effects(wanted: Sequence[effects.Variant], out: Path, part: str = "") -> list[Run]:
    """Return the runs of variants whose effects would be measured: with all, and without each."""
    points = [
        (
            part or f"{one.name} {one.scene.name}".strip(),
            one.key,
            partial(getattr, one, "scene"),
            [DEM.name] * (1 + len(active_effects(one.scene))),
        )
        for one in wanted
    ]
    return _to_do(points, out)


def of_report(scenes: Iterable[Sequence[AnyScene]], out: Path | None) -> list[Run]:
    """Return the runs of the report: of its scenes, and in `out` of its studies; None: without."""
    found = [run for variants in scenes for run in all_runs(variants, "scenes")]
    if out is None:
        return found
    for name in (*work_precision.REPORTED, *scattering.SOLVERS, hard_cases.NAME):
        found += of_study(name, out / "studies", brief=True)
    return found + of_effects(effects.reported(), out / "effects", "effects")


def _to_do(points: Iterable[Point], folder: Path) -> list[Run]:
    found: list[Run] = []
    done: Store[object] = Store(None, folder)
    for part, key, read, solvers in points:
        if not done.has(key):
            with suppress(SceneError):  # it fails before its first step
                scene = read()
                found += [(part, scene, name) for name in solvers]
    return found
