"""What commands over many runs would do: the parts of a study, of the report, of the effects."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from compare.experiments.cost import timings

Part = dict[str, Any]


def _part(part: str, count: int, done: int, each: float | None) -> Part:
    """Return a part: how many it has, how many of them are to do, and their seconds.

    each : seconds of one, None where none was ever timed here.
    """
    left = count - done
    seconds = 0.0 if not left else None if each is None else each * left
    return {"part": part, "count": count, "to_do": left, "seconds": seconds}


def parts_of_study(name: str, out: Path) -> list[Part]:
    """Return the curves of a study, or the rows of the hard cases."""
    if name == "stability":
        return [_hard_cases(out, slow=True)]
    from compare.experiments.study.runner import is_kept, rate
    from compare.experiments.study.study import load

    study, parts = load(name), []
    for curve in study.curves:
        points = study.model_copy(update={"curves": [curve]}).points()
        done = sum(is_kept(point, out / Path(name).stem) for point in points)
        label = f"{Path(name).stem}: {curve.label} ({curve.method})"
        parts.append(_part(label, len(points), done, timings.whole(rate(study))))
    return parts


def _hard_cases(out: Path, slow: bool) -> Part:
    from compare.experiments.robustness import run
    from compare.experiments.robustness.section import NAME

    rows = run.places(slow)
    done = sum(run.is_kept(place, out / NAME) for place in rows)
    return _part("hard cases", len(rows), done, timings.whole(run.RATE))


def parts_of_effects(wanted: list[Any], out: Path) -> list[Part]:
    """Return the variants whose effects would be weighed."""
    from compare.experiments.ablation.runner import RATE, is_complete

    each = timings.whole(RATE)
    names = [f"{case.name} {case.scene.name}".strip() for case in wanted]
    done = [is_complete(case, out) for case in wanted]
    return [_part(name, 1, int(is_done), each) for name, is_done in zip(names, done, strict=True)]


def parts_of_report(scenes: Sequence[str], out: Path) -> list[Part]:
    """Return the parts of the report of some scenes; without any, of the paper's and the studies.

    Raises SceneError for a scene that there is not.
    """
    from compare.experiments.ablation import runner as ablation_runs
    from compare.experiments.study.section import REPORTED
    from compare.report.scenes import RATE, asked_for

    first = _part("scenes", len(asked_for(scenes)), 0, timings.whole(RATE))
    if scenes:
        return [first]
    weighed = ablation_runs.reported()
    known = sum(ablation_runs.is_complete(case, out / "effects") for case in weighed)
    parts = [first]
    for name in REPORTED:
        parts += parts_of_study(name, out / "studies")
    parts.append(_hard_cases(out / "studies", slow=False))
    return [*parts, _part("effects", len(weighed), known, timings.whole(ablation_runs.RATE))]
