"""`--dry-run`: the steps, size, seconds and memory of runs before they start."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.size import spoken
from compare.cli.terminal import print_json, progress, say, show_table
from compare.engines import applies, names, solver
from compare.experiments.cost import timings

COLUMNS = ["", "variant", "engine", "scheme", "steps", "size", "time", "memory"]
UNKNOWN = "no estimate"  # no such run has been timed on this machine
Run = tuple[str, "AnyScene", str]  # the point of a sweep, empty without; the scene; its solver


class Forecast(NamedTuple):
    """The estimate of a run.

    steps : of time, exactly; 0 for exact solutions. size : blocks or freedoms, in words.
    seconds : of stepping, at the rate last measured here; None if never measured. bytes : of
        memory, as the run itself estimates it at its start; for exact solutions that of their
        waveforms, a lower bound.
    """

    variant: str
    engine: str
    steps: int
    size: str
    scheme: str
    seconds: float | None
    bytes: float


def forecast(scene: AnyScene, name: str) -> Forecast:
    """Return the estimated cost of a run of an engine or exact solution.

    Raises SceneError if it cannot be run, as the run would.
    """
    one = solver(name)
    run = one.prepare(scene)
    seconds = timings.stepping(name, scene, run.settings, run.steps, run.freedoms)
    size = f"{one.units(scene, run.freedoms):,} {one.unit}" if run.steps else "-"
    return Forecast(scene.name, name, run.steps, size, run.scheme, seconds, run.bytes)


def seconds_of(found: Iterable[Forecast]) -> tuple[float, int]:
    """Return the total seconds of runs with a timing, and the number of runs without one."""
    known = [one.seconds for one in found]
    return sum(s for s in known if s is not None), known.count(None)


def show_all(scenes: list[AnyScene], as_json: bool) -> None:
    """Print the estimated cost of all solvers that apply to some scenes."""
    show_runs([("", s, name) for s in scenes for name in names() if applies(name, s)], as_json)


def show_runs(
    wanted: Sequence[Run], as_json: bool, failing: Sequence[tuple[str, str]] = ()
) -> None:
    """Print the estimated cost of each run by its point of a sweep, and the total.

    failing : points that would not run, with the reason. Raises SceneError for a run that is not
    possible; at a point of a sweep it is listed as failing.
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
    (_print_facts if as_json else _print_table)(found, failed)


def _print_facts(found: list[tuple[str, Forecast]], failed: dict[str, str]) -> None:
    seconds, unknown = seconds_of(one for _, one in found)
    runs = [{"point": point, **one._asdict()} for point, one in found]
    failing = [{"point": point, "message": message} for point, message in failed.items()]
    print_json({"runs": runs, "seconds": seconds, "untimed": unknown, "failing": failing})


def _print_table(found: list[tuple[str, Forecast]], failed: dict[str, str]) -> None:
    first = 0 if any(point for point, _ in found) else 1
    show_table(COLUMNS[first:], [_cells(point, one)[first:] for point, one in found])
    for point, message in failed.items():
        say(f"would fail: {point}: {message}", "red")
    most = max((one.bytes for _, one in found), default=0.0)
    say(
        f"{len(found)} would run, {_together(*seconds_of(one for _, one in found))}; the largest "
        f"needs about {spoken(most)} of memory; nothing was run or written"
    )


def _together(seconds: float, unknown: int) -> str:
    """Return in words the total seconds of runs, of which some were never timed."""
    if unknown and not seconds:
        return f"{UNKNOWN} of the time: nothing of the kind was timed on this machine"
    others = f", plus {unknown} not timed on this machine" if unknown else ""
    return f"about {in_words(seconds)} of CPU time{others}"


def in_words(seconds: float) -> str:
    """Return a time to two digits, in a suitable unit."""
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
