"""The steps, size, seconds and memory of runs before they start."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import applies, names, solver
from jointwave.compare.runs import timings

UNKNOWN = "no estimate"  # no such run has been timed on this machine
Run = tuple[str, AnyScene, str]  # the point of a sweep, empty without; the scene; its solver


class Forecast(NamedTuple):
    """The estimate of a run.

    steps : of time, exactly; 0 for exact solutions. size : blocks or freedoms, in words.
    seconds : of stepping, at the rate last measured here; None if never measured. bytes : of
        memory, as the run itself estimates it at its start; for exact solutions that of their
        waveforms, a lower bound.
    """

    point: str
    variant: str
    engine: str
    steps: int
    size: str
    scheme: str
    seconds: float | None
    bytes: float


@dataclass(frozen=True)
class Part:
    """A part of a command: its number of points, and how many remain to be computed.

    seconds : of those whose runs were timed here before. untimed : the number of the other runs.
    """

    part: str
    count: int
    to_do: int
    seconds: float
    untimed: int


def forecast(scene: AnyScene, name: str, point: str = "") -> Forecast:
    """Return the estimated cost of a run of an engine or exact solution.

    Raises SceneError if it cannot be run, as the run would.
    """
    one = solver(name)
    run = one.prepare(scene)
    size = f"{one.units(scene, run.freedoms):,} {one.unit}" if run.steps else "-"
    seconds = timings.stepping(name, scene, run)
    return Forecast(point, scene.name, name, run.steps, size, run.scheme, seconds, run.bytes)


def forecasts(
    wanted: Sequence[Run], progress: Callable[[float], None] = lambda fraction: None
) -> tuple[list[Forecast], dict[str, str]]:
    """Return the estimate of each run, and why points of a sweep would fail.

    Raises SceneError for a run that is not possible and no point of a sweep.
    """
    found: list[Forecast] = []
    failing = {}
    for i, (point, scene, name) in enumerate(wanted):
        try:
            found.append(forecast(scene, name, point))
        except SceneError as error:
            if not point:
                raise
            failing[point] = str(error)
        progress((i + 1) / len(wanted))
    return found, failing


def all_runs(scenes: Iterable[AnyScene]) -> list[Run]:
    """Return the runs of all solvers that apply to some scenes."""
    return [("", scene, name) for scene in scenes for name in names() if applies(name, scene)]


def total(seconds: Iterable[float | None]) -> tuple[float, int]:
    """Return the sum of the known seconds, and the number of unknown ones."""
    known = list(seconds)
    return sum(s for s in known if s is not None), known.count(None)


def part(label: str, count: int, to_do: Sequence[Sequence[Run]]) -> Part:
    """Return a part of a command; to_do : the runs of each point that is not done."""
    seconds = [_seconds(scene, name) for runs in to_do for _, scene, name in runs]
    return Part(label, count, len(to_do), *total(seconds))


def _seconds(scene: AnyScene, name: str) -> float | None:
    """Return the seconds of a run; None if unknown, 0 if it fails before its first step."""
    try:
        return forecast(scene, name).seconds if name in names() else None
    except SceneError:
        return 0.0
