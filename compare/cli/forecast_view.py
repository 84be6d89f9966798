"""The output of `--dry-run`: the estimates of runs, one by one and together."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from jointwave.cases.size import spoken
from jointwave.compare.cli.terminal import print_json, progress, say, show_table
from jointwave.compare.studies.forecast import Run, forecasts
from jointwave.compare.text import in_seconds

UNKNOWN = "no estimate"  # no such run has been timed on this machine


def show_forecasts(
    wanted: Sequence[Run], as_json: bool, failing: Mapping[str, str] | None = None
) -> None:
    """Print the estimated cost of each run, and of all together.

    failing : points of a sweep that would not run, with the reason; more are found here. Raises
    SceneError for a run that is not possible and no point of a sweep.
    """
    with progress(f"{len(wanted)} runs") as advance:
        table, failed = forecasts(wanted, advance)
    failed = {**(failing or {}), **failed}
    if as_json:
        facts: dict[str, Any] = {"runs": table.to_dict("records"), "seconds": table.seconds.sum()}
        facts |= {"untimed": int(table.seconds.isna().sum())}
        failures = [{"point": point, "message": text} for point, text in failed.items()]
        print_json(facts | {"failing": failures})
        return
    first = 0 if table.point.any() else 1
    columns = ["", "variant", "engine", "scheme", "steps", "size", "time", "memory"]
    show_table(columns[first:], [_cells(one)[first:] for one in table.itertuples()])
    for point, message in failed.items():
        say(f"would fail: {point}: {message}", "red")
    most = f"the largest needs about {spoken(table.bytes.max())} of memory; " if len(table) else ""
    say(f"{len(table)} would run, {_time(table.seconds)}; {most}nothing was run or written")


def _time(seconds: pd.Series) -> str:
    """Return in words the total seconds of runs, some of which were never timed."""
    untimed = int(seconds.isna().sum())
    if untimed and not seconds.sum():
        return f"{UNKNOWN} of the time: nothing of the kind was timed on this machine"
    others = f", plus {untimed} not timed on this machine" if untimed else ""
    return f"about {in_seconds(seconds.sum())} of CPU time{others}"


def _cells(one: Any) -> list[str]:
    return [
        one.point,
        one.variant or "-",
        one.engine,
        one.scheme,
        f"{one.steps:,}" if one.steps else "-",
        one.size,
        UNKNOWN if pd.isna(one.seconds) else in_seconds(one.seconds),
        spoken(one.bytes) if one.steps else f"over {spoken(one.bytes)}",
    ]
