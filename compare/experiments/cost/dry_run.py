"""The output of `--dry-run`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from cases.errors import SceneError
from cases.schema.scene import Scene
from cases.size import spoken
from compare.cli.terminal import print_json, progress, say, show_table
from compare.engines import applies, names
from compare.experiments.cost.run_cost import Forecast, forecast, seconds_of

if TYPE_CHECKING:
    from compare.experiments.cost.experiment_cost import Part

COLUMNS = ["", "variant", "engine", "scheme", "steps", "size", "time", "memory"]
UNKNOWN = "no estimate"  # where nothing of the kind was ever timed here


Run = tuple[str, Scene, str]  # the point of a sweep, empty without; the scene; what solves it


def show_all(scenes: list[Scene], as_json: bool) -> None:
    """Print what everything that applies to some scenes would take."""
    show_runs([("", s, name) for s in scenes for name in names() if applies(name, s)], as_json)


def show_runs(
    wanted: Sequence[Run], as_json: bool, failing: Sequence[tuple[str, str]] = ()
) -> None:
    """Print what each run would take under its point of a sweep, and all of them together.

    failing : points that would not run, with the reason. Raises SceneError for a run that cannot be
    made; at a point of a sweep it is one that fails.
    """
    found: list[tuple[str, Forecast]] = []
    failed = dict(failing)
    with progress(f"{len(wanted)} runs") as advance:
        for i, (point, scene, name) in enumerate(wanted):
            try:
                found.append((point, forecast(scene, name)))
            except SceneError as error:
                if not point:
                    raise
                failed[point] = str(error)
            advance((i + 1) / len(wanted))
    _show_forecasts(found, failed, as_json)


def _show_forecasts(
    found: list[tuple[str, Forecast]], failed: dict[str, str], as_json: bool
) -> None:
    seconds, unknown = seconds_of(one for _, one in found)
    if as_json:
        runs = [{"point": point, **one._asdict()} for point, one in found]
        failing = [{"point": point, "message": message} for point, message in failed.items()]
        print_json({"runs": runs, "seconds": seconds, "untimed": unknown, "failing": failing})
        return
    first = 0 if any(point for point, _ in found) else 1
    show_table(COLUMNS[first:], [_cells(point, one)[first:] for point, one in found])
    for point, message in failed.items():
        say(f"would fail: {point}: {message}", "red")
    most = max((one.bytes for _, one in found), default=0.0)
    say(
        f"{len(found)} would run, {together(seconds, unknown)}; the largest takes about "
        f"{spoken(most)} of memory; nothing has been run or written"
    )


def together(seconds: float, unknown: int) -> str:
    """Return in words the seconds of runs one after the other, of which some were never timed."""
    if not unknown:
        return f"about {in_words(seconds)} of computing"
    if not seconds:
        return f"{UNKNOWN} of the time: none of the kind was ever timed here"
    return f"about {in_words(seconds)} of computing, and {unknown} that were never timed here"


def in_words(seconds: float) -> str:
    """Return a time to two digits, in the unit that fits."""
    for unit, length in (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)):
        if seconds >= length:
            return f"{seconds / length:.3g} {unit}"
    return "under 1 ms"


def _cells(point: str, one: Forecast) -> list[str]:
    return [
        point,
        one.variant or "-",
        one.engine,
        one.scheme,
        f"{one.steps:,}" if one.steps else "-",
        one.size,
        UNKNOWN if one.seconds is None else in_words(one.seconds),
        spoken(one.bytes) if one.steps else f"over {spoken(one.bytes)}",
    ]


def show_parts(found: Sequence[Part], as_json: bool) -> None:
    """Print the parts of a command that is more than runs: how many points, how many to do."""
    if as_json:
        print_json([asdict(one) for one in found])
        return
    rows = [
        [
            one.part,
            f"{one.to_do} of {one.count} to do",
            UNKNOWN if one.seconds is None else f"about {in_words(one.seconds)}",
        ]
        for one in found
    ]
    show_table(["part", "", "time"], rows)
    say("nothing has been run or written")
