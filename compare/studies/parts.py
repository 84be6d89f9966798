"""The parts of commands over many runs, for `--dry-run`: a study, effects of scenes, the report.

The time of a part is that of its runs that are not done.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import effects, hard_cases, scattering, work_precision
from jointwave.compare.studies.forecast import Part, Run, all_runs, part
from jointwave.compare.studies.store import Store
from jointwave.compare.studies.study import load


def of_study(name: str, out: Path) -> list[Part]:
    """Return the curves of a study, the rows of the hard cases or the waves at joints."""
    if name == hard_cases.NAME:
        return [_hard_cases(out)]
    if name in scattering.SOLVERS:
        return [_joints(name, out)]
    study, stem = load(name), Path(name).stem
    curves = (study.model_copy(update={"curves": [curve]}) for curve in study.curves)
    return [
        _part(
            f"{stem}: {one.curves[0].label} ({one.curves[0].method})",
            one.points(),
            work_precision.key,
            lambda x: [("", x.scene, x.curve.method)],
            out / stem,
        )
        for one in curves
    ]


def of_effects(wanted: Sequence[effects.Variant], out: Path) -> list[Part]:
    """Return the variants whose effects would be measured: a run with all, one without each."""
    return [
        _part(f"{one.name} {one.scene.name}".strip(), [one], lambda x: x.key, _of_effects, out)
        for one in wanted
    ]


def of_report(scenes: Iterable[Sequence[AnyScene]], out: Path | None) -> list[Part]:
    """Return the parts of the report: the variants of its scenes, and in `out` all of its studies;
    None: without any."""
    runs = [all_runs(variants) for variants in scenes]
    found = [part("scenes", len(runs), runs)]
    if out is None:
        return found
    studies = out / "studies"
    found += [one for name in work_precision.REPORTED for one in of_study(name, studies)]
    found += [_joints(name, studies, brief=True) for name in scattering.SOLVERS]
    found.append(_hard_cases(studies))
    cases = effects.reported()
    return [*found, _part("effects", cases, lambda x: x.key, _of_effects, out / "effects")]


def _part(
    label: str,
    points: Sequence[Any],
    key: Callable[[Any], str],
    runs: Callable[[Any], list[Run]],
    folder: Path,
) -> Part:
    """Return a part; runs : of a point; key, folder : of its result in the store."""
    done = Store[Any](None, folder)

    def of_point(point: Any) -> list[Run]:
        try:
            return runs(point)
        except SceneError:
            return []  # it fails before its first step

    to_do = [of_point(point) for point in points if not done.has(key(point))]
    return part(label, len(points), to_do)


def _joints(name: str, out: Path, brief: bool = False) -> Part:
    points = scattering.points(name, brief)

    def runs(point: scattering.JointsPoint) -> list[Run]:
        return [("", scattering.scene_of(*point[1:]), point.solver)]

    return _part(name, points, scattering.key, runs, out / name)


def _hard_cases(out: Path) -> Part:
    found, folder = hard_cases.hard_cases(), out / hard_cases.NAME
    return _part("hard cases", found, hard_cases.key, lambda x: [("", x.read(), x.engine)], folder)


def _of_effects(one: effects.Variant) -> list[Run]:
    return [("", one.scene, DEM.name)] * (1 + len(active_effects(one.scene)))
