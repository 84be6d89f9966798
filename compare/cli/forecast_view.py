"""The output of `--dry-run`: estimates of runs, and of the parts of a study or the report."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

from jointwave.cases.size import spoken
from jointwave.compare.cli.terminal import print_json, progress, say, show_table
from jointwave.compare.studies.forecast import UNKNOWN, Forecast, Part, Run, forecasts, total

COLUMNS = ["", "variant", "engine", "scheme", "steps", "size", "time", "memory"]


def show_runs(
    wanted: Sequence[Run], as_json: bool, failing: Mapping[str, str] | None = None
) -> None:
    """Print the estimated cost of each run by its point of a sweep, and the total.

    failing : points that would not run, with the reason. Raises SceneError for a run that is not
    possible and no point of a sweep.
    """
    with progress(f"{len(wanted)} runs") as advance:
        found, failed = forecasts(wanted, advance)
    failed = {**(failing or {}), **failed}
    seconds, untimed = total(one.seconds for one in found)
    if as_json:
        runs = [one._asdict() for one in found]
        failures = [{"point": point, "message": text} for point, text in failed.items()]
        print_json({"runs": runs, "seconds": seconds, "untimed": untimed, "failing": failures})
        return
    first = 0 if any(one.point for one in found) else 1
    show_table(COLUMNS[first:], [_cells(one)[first:] for one in found])
    for point, message in failed.items():
        say(f"would fail: {point}: {message}", "red")
    most = max((one.bytes for one in found), default=0.0)
    say(
        f"{len(found)} would run, {_together(seconds, untimed)}; the largest needs about "
        f"{spoken(most)} of memory; nothing was run or written"
    )


def show_parts(found: Sequence[Part], as_json: bool) -> None:
    """Print the parts of a command: numbers of points, in all and remaining, and their time."""
    if as_json:
        print_json([asdict(one) for one in found])
        return
    rows = [
        [one.part, f"{one.to_do} of {one.count} to do", _together(one.seconds, one.untimed)]
        for one in found
    ]
    show_table(["part", "", "time"], rows)
    say("nothing was run or written")


def in_words(seconds: float) -> str:
    """Return a time to three digits, in a suitable unit."""
    for unit, length in (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)):
        if seconds >= length:
            return f"{seconds / length:.3g} {unit}"
    return "under 1 ms"


def _together(seconds: float, untimed: int) -> str:
    """Return in words the total seconds of runs, some of which were never timed."""
    if untimed and not seconds:
        return f"{UNKNOWN} of the time: nothing of the kind was timed on this machine"
    others = f", plus {untimed} not timed on this machine" if untimed else ""
    return f"about {in_words(seconds)} of CPU time{others}"


def _cells(one: Forecast) -> list[str]:
    return [
        one.point,
        one.variant or "-",
        one.engine,
        one.scheme,
        f"{one.steps:,}" if one.steps else "-",
        one.size,
        UNKNOWN if one.seconds is None else in_words(one.seconds),
        spoken(one.bytes) if one.steps else f"over {spoken(one.bytes)}",
    ]
