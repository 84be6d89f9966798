"""`--dry-run` of commands over many runs: the parts of a study, of the report, of the effects."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from compare.cli.terminal import print_json, say, show_table
from compare.experiments.ablation import runner as ablation
from compare.experiments.cost import timings
from compare.experiments.cost.dry_run import UNKNOWN, in_words
from compare.experiments.scattering import points as scattering
from compare.experiments.study import summary as studies
from compare.experiments.study.measure import PointRow
from compare.experiments.study.study import load
from compare.experiments.study.summary import REPORTED
from compare.studies import hard_cases
from compare.studies.store import Store


@dataclass(frozen=True)
class CommandPart:
    """A part of a command: its number of points, and how many remain to be computed; seconds : of
    those, None if never timed here."""

    part: str
    count: int
    to_do: int
    seconds: float | None


def _part(part: str, store: Store, keys: Sequence[str], rate: str) -> CommandPart:
    """Return a part; rate : key of the timings of a point."""
    left, each = sum(not store.has(key) for key in keys), timings.whole(rate)
    seconds = 0.0 if not left else None if each is None else each * left
    return CommandPart(part, len(keys), left, seconds)


def parts_of_study(name: str, out: Path) -> list[CommandPart]:
    """Return the curves of a study, the rows of the hard cases or the waves at joints."""
    if name == hard_cases.NAME:
        return [_hard_cases(out)]
    if name in scattering.SOLVERS:
        return [_joints(name, out)]
    study, stem = load(name), Path(name).stem
    rows, parts = Store[PointRow](PointRow, out / stem), []
    for curve in study.curves:
        points = study.model_copy(update={"curves": [curve]}).points()
        label = f"{stem}: {curve.label} ({curve.method})"
        parts.append(_part(label, rows, list(map(studies.key, points)), studies.rate(study)))
    return parts


def _joints(name: str, out: Path, brief: bool = False) -> CommandPart:
    done = Store[scattering.JointsRow](scattering.JointsRow, out / name)
    keys = list(map(scattering.key, scattering.points(name, brief)))
    return _part(name, done, keys, scattering.RATE)


def _hard_cases(out: Path) -> CommandPart:
    rows = Store[hard_cases.HardRow](hard_cases.HardRow, out / hard_cases.NAME)
    keys = list(map(hard_cases.key, hard_cases.hard_cases()))
    return _part("hard cases", rows, keys, hard_cases.RATE)


def parts_of_effects(wanted: Sequence[ablation.Variant], out: Path) -> list[CommandPart]:
    """Return the variants whose effects would be measured."""
    done = ablation.ablations(out)
    return [
        _part(f"{case.name} {case.scene.name}".strip(), done, [case.key], ablation.RATE)
        for case in wanted
    ]


def parts_of_report(scenes: Sequence[str], out: Path) -> list[CommandPart]:
    """Return the parts of the report of some scenes; without any, of the paper's and the studies.

    Raises SceneError for an unknown scene.
    """
    from compare.report.scenes import RATE, ROCK_MASSES, asked_for

    asked = [*asked_for(scenes), *(() if scenes else asked_for(ROCK_MASSES))]
    first = _part("scenes", Store(None, None), list(map(str, asked)), RATE)
    if scenes:
        return [first]
    of_studies = [part for name in REPORTED for part in parts_of_study(name, out / "studies")]
    of_joints = [_joints(name, out / "studies", brief=True) for name in scattering.SOLVERS]
    effects = [case.key for case in ablation.reported()]
    return [
        first,
        *of_studies,
        *of_joints,
        _hard_cases(out / "studies"),
        _part("effects", ablation.ablations(out / "effects"), effects, ablation.RATE),
    ]


def show_parts(found: Sequence[CommandPart], as_json: bool) -> None:
    """Print the parts of a command: numbers of points, in all and remaining."""
    if as_json:
        print_json([asdict(one) for one in found])
        return
    times = [UNKNOWN if x.seconds is None else f"about {in_words(x.seconds)}" for x in found]
    points = [f"{one.to_do} of {one.count} to do" for one in found]
    rows = [[one.part, *cells] for one, *cells in zip(found, points, times, strict=True)]
    show_table(["part", "", "time"], rows)
    say("nothing was run or written")
