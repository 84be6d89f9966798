"""The output of `--dry-run`: the estimated cost of each run and of the command."""

from collections.abc import Callable, Mapping, Sequence
from time import process_time
from typing import Any

from jointwave.cases.size import spoken
from jointwave.compare.cli.terminal import print_json, progress, say, show_frame
from jointwave.compare.runs.timings import each
from jointwave.compare.studies.forecast import Run, forecasts
from jointwave.compare.studies.forecast import runs_of as runs_of
from jointwave.compare.text import in_seconds

SPARE = 5.0  # s, for trying kinds of runs that were never timed
HEADS = {
    **{name: name for name in ("point", "variant", "engine", "scheme", "steps", "size")},
    **{"times": "runs", "seconds": "time", "bytes": "memory"},
}
WORDS: dict[str, Callable[[Any], str]] = {
    "steps": "{:,}".format,
    "times": "{:,.0f}".format,
    "seconds": in_seconds,
    "bytes": spoken,
}
MOST = 25  # rows; more are summed by point and engine


def show_forecasts(
    wanted: Sequence[Run],
    as_json: bool,
    parts: Mapping[str, float] = {},
    failing: Mapping[str, str] = {},
) -> None:
    """Print the estimated cost of each run, and of the whole command.

    failing : points of a sweep known to fail, with reasons; more are found here. parts : numbers of
    other tasks, see `timings.OTHERWISE`. Raises SceneError for an impossible run without a point.
    """
    begun = process_time()  # starting the command takes as long as starting this one
    with progress(f"{len(wanted)} runs") as advance:
        table, failed = forecasts(wanted, advance, SPARE)
    failed, count = {**failing, **failed}, table.times.sum()
    total, read = begun + table.seconds.sum(), sum(run.is_read for run in wanted)
    kind = wanted[0].scene.kind if wanted else ""
    others = {what: n * each(what, kind) for what, n in parts.items() if n}
    total, untimed = total + sum(others.values()), int(table.stepping.isna().sum())
    if as_json:
        facts: dict[str, Any] = {"runs": table.to_dict("records"), "seconds": total, "read": read}
        facts |= {"parts": others, "untimed": untimed}
        failures = [{"point": point, "message": text} for point, text in failed.items()]
        print_json(facts | {"failing": failures})
        return
    if len(table) > MOST:
        how = {"times": "sum", "seconds": "sum", "bytes": "max"}
        table = table.groupby(["point", "engine"], sort=False, as_index=False).agg(how)
    cells = table.assign(**{x: table[x].map(how) for x, how in WORDS.items() if x in table})
    filled = [name for name in HEADS if name in cells and cells[name].astype(bool).any()]
    show_frame(cells[filled].rename(columns=HEADS))
    for point, message in failed.items():
        say(f"would fail: {point}: {message}", "red")
    said = [f"{read} would be read"] * bool(read)
    said += [f"{what}: {parts[what]:,} in {in_seconds(s)}" for what, s in others.items()]
    said += [f"about {in_seconds(total)} of CPU time"]
    said += [f"{untimed} not timed on this machine"] * bool(untimed)
    say(f"{count:,.0f} would run, {', '.join(said)}; nothing was written")
