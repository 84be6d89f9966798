"""What `--dry-run` shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cases.schema.scene import Scene
from cases.size import spoken
from compare.cli.terminal import print_json, progress, say, show_table
from compare.engines import applies, names
from compare.experiments.cost import experiment_cost
from compare.experiments.cost.run_cost import Forecast, forecast, seconds_of

COLUMNS = ["", "variant", "engine", "scheme", "steps", "size", "time", "memory"]
UNKNOWN = "no estimate"  # where nothing of the kind was ever timed here


def show_runs(wanted: list[tuple[Scene, str]], as_json: bool) -> None:
    """Print what so many (scene, engine) would take."""
    with progress(f"{len(wanted)} runs") as advance:
        found = []
        for i, (scene, name) in enumerate(wanted):
            found.append(("", forecast(scene, name)))
            advance((i + 1) / len(wanted))
    show_forecasts(found, as_json)


def show_all(scenes: list[Scene], as_json: bool) -> None:
    """Print what everything that applies to some scenes would take."""
    show_runs([(s, name) for s in scenes for name in names() if applies(name, s)], as_json)


def show_forecasts(
    found: list[tuple[str, Forecast]],
    as_json: bool,
    failing: list[tuple[str, str]] = [],  # noqa: B006
) -> None:
    """Print what would run under its point of a sweep, empty without, and all of it together.

    failing : points that would not run, with the reason.
    """
    seconds, unknown = seconds_of(one for _, one in found)
    if as_json:
        runs = [{"point": point, **one._asdict()} for point, one in found]
        failed = [{"point": point, "message": message} for point, message in failing]
        print_json({"runs": runs, "seconds": seconds, "untimed": unknown, "failing": failed})
        return
    first = 0 if any(point for point, _ in found) else 1
    rows = [_cells(point, one)[first:] for point, one in found]
    show_table(COLUMNS[first:], rows)
    for point, message in failing:
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


def show_study(name: str, out: Path, as_json: bool) -> None:
    """Print the curves of a study."""
    _show_parts(experiment_cost.parts_of_study(name, out), as_json)


def show_effects(wanted: list[Any], out: Path, as_json: bool) -> None:
    """Print the variants whose effects would be weighed."""
    _show_parts(experiment_cost.parts_of_effects(wanted, out), as_json)


def show_report(scenes: Sequence[str], out: Path, as_json: bool) -> None:
    """Print the parts of the report of some scenes, or of the paper's."""
    _show_parts(experiment_cost.parts_of_report(scenes, out), as_json)


def _show_parts(found: list[dict[str, Any]], as_json: bool) -> None:
    """Print the parts of a command that is more than runs: what, how many, of those done."""
    if as_json:
        print_json(found)
        return
    rows = [
        [
            part["part"],
            f"{part['to_do']} of {part['count']} to do",
            UNKNOWN if part["seconds"] is None else f"about {in_words(part['seconds'])}",
        ]
        for part in found
    ]
    show_table(["part", "", "time"], rows)
    say("nothing has been run or written")
