"""Estimates of steps, size, seconds and memory of runs before they start."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import partial
from time import process_time
from typing import NamedTuple

import pandas as pd

from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress, applies, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.studies.measure import LONG
from jointwave.compare.studies.step_cost import shortened
from jointwave.compare.studies.store import Row

ENOUGH = 10_000_000  # steps times blocks or freedoms, for which starting a run costs little


class Run(NamedTuple):
    """A solution that a command would compute.

    point : of a sweep, or the part of a study or page; "" if none. times : number of repetitions.
    again : additional repetitions if the run is so short that its timing is repeated. is_read :
    whether a saved result is read instead. for_paraview : whether snapshots become files.
    may_fail : whether the command continues without it, as it does if it has a point.
    """

    point: str
    scene: AnyScene
    name: str
    times: float = 1.0
    again: int = 0
    is_read: bool = False
    for_paraview: bool = False
    may_fail: bool = False


def runs_of(
    names: Iterable[str], scene: AnyScene, stored: ResultFolder, suffix: str = "", point: str = ""
) -> list[Run]:
    """Return the runs of the solvers that apply; results in the folder `stored` are read."""
    able = {name: stored.has(name, scene, suffix) for name in names if applies(name, scene)}
    return [Run(point, scene, name, is_read=x, may_fail=True) for name, x in able.items()]


#: Columns of an estimate. steps : exact number of time steps; 0 for exact solutions. size : blocks
#: or freedoms, in words. stepping : seconds, from the rate last measured on this machine; None if
#: never measured. setup : seconds before the first step. seconds : of all repetitions, with
#: snapshots. bytes : of memory, the run's own estimate; for exact solutions the memory of their
#: waveforms, a lower bound.
COLUMNS = (
    *("point", "variant", "engine", "scheme", "steps", "size"),
    *("stepping", "setup", "times", "seconds", "bytes"),
)


def forecast(run: Run) -> Row:
    """Return the estimated cost of a run of an engine or an exact solution.

    Raises SceneError if it cannot be run, as the run would.
    """
    one, began = solver(run.name), process_time()
    found = one.prepare(run.scene)
    setup = timings.setup(run.name, run.scene)
    if setup is None:
        setup = process_time() - began if found.steps else 0.0
    units = one.units(run.scene, found.freedoms)
    size = f"{units:,} {one.unit}" if found.steps else "-"
    stepping = timings.stepping(run.name, run.scene, found)
    times = run.times + (run.again if stepping is not None and stepping <= LONG else 0)
    guess = timings.OTHERWISE.get(found.scheme, timings.OTHERWISE["explicit"])
    each = setup + (guess * max(found.steps * units, 1) if stepping is None else stepping)
    if found.steps and (interval := run.scene.record.fields):
        taken = timings.OTHERWISE[one.unit + " for ParaView" * run.for_paraview]
        each += (run.scene.time.duration / interval + 1) * units * taken
    about = run.point, run.scene.name, run.name, found.scheme, found.steps, size
    cost = stepping, setup, times, times * each, found.bytes
    return dict(zip(COLUMNS, (*about, *cost), strict=True))


def forecasts(
    wanted: Sequence[Run], progress: Progress = lambda fraction: None, spare: float = 0.0
) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the estimates of all runs that are not read, a row each, and why points would fail.

    spare : CPU seconds that may be spent on first steps of runs whose kind was never timed on this
    machine. Raises SceneError for an impossible run that may not fail.
    """
    found: list[Row] = []
    failing, kinds, began = dict[str, str](), set(), process_time()
    for i, run in enumerate(wanted):
        if run.is_read:
            continue
        try:
            one = forecast(run)
            if one["stepping"] is None and process_time() < began + spare:
                _time(run)
                one = forecast(run)
            kind = one["engine"], one["scheme"], *active_effects(run.scene)
            if one["stepping"] is None and one["steps"] and kind not in kinds:
                one["seconds"] += timings.OTHERWISE["kernels"]
                kinds.add(kind)
            found.append(one)
        except SceneError as error:
            if not (run.point or run.may_fail):
                raise
            where = run.point or f"{run.scene.name} {run.name}".strip()
            failing[where] = "; ".join(filter(None, (failing.get(where), str(error))))
        progress((i + 1) / len(wanted))
    table = pd.DataFrame(found, columns=COLUMNS)
    return table.astype({"seconds": float}), failing


def _time(run: Run) -> None:
    """Run the beginning of a scene and save its cost, if it is stable; the first run compiles.

    The set-up time is that of the whole scene.
    """
    short = shortened(run.scene, run.name, ENOUGH)
    with suppress(UnstableError):
        for _ in range(2):
            result, *cost = timings.timed(partial(solve, run.name, short))
        timings.note(run.name, run.scene if run.name in ENGINES else short, result.attrs, *cost)
