"""The steps, size, seconds and memory of runs before they start."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import pandas as pd

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import applies, names, solver
from jointwave.compare.runs import timings

Run = tuple[str, AnyScene, str]  # the point of a sweep, empty without; the scene; its solver


class Forecast(NamedTuple):
    """The estimate of a run.

    point : of a sweep, "" without. steps : of time, exactly; 0 for exact
    solutions. size : blocks or freedoms, in words. seconds : of stepping, at the rate last measured
    here; None if never measured. bytes : of memory, as the run itself estimates it at its start;
    for exact solutions that of their waveforms, a lower bound.
    """

    point: str
    variant: str
    engine: str
    scheme: str
    steps: int
    size: str
    seconds: float | None
    bytes: float


def forecast(scene: AnyScene, name: str, point: str = "") -> Forecast:
    """Return the estimated cost of a run of an engine or exact solution.

    Raises SceneError if it cannot be run, as the run would.
    """
    one = solver(name)
    run = one.prepare(scene)
    size = f"{one.units(scene, run.freedoms):,} {one.unit}" if run.steps else "-"
    seconds = timings.stepping(name, scene, run)
    return Forecast(point, scene.name, name, run.scheme, run.steps, size, seconds, run.bytes)


def forecasts(
    wanted: Sequence[Run], progress: Callable[[float], None] = lambda fraction: None
) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the table of estimates, a `Forecast` a row, and why points would fail.

    Raises SceneError for a run that is not possible and has no point.
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
    table = pd.DataFrame(found, columns=Forecast._fields)
    return table.astype({"seconds": float}), failing


def all_runs(scenes: Iterable[AnyScene]) -> list[Run]:
    """Return the runs of all solvers that apply to some scenes."""
    return [("", scene, name) for scene in scenes for name in names() if applies(name, scene)]
