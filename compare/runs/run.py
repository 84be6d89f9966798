"""Execution of the jobs of `jointwave run`, with checkpoints and complete files."""

import json
import os
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, TypeVar

import xarray as xr

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.compare.engines import Progress, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.runs.checkpoint.resume import CheckpointSettings, RunCheckpointer
from jointwave.compare.runs.checkpoint.signals import Signals
from jointwave.compare.runs.jobs import Job
from jointwave.compare.runs.output import write_dataset, write_pvd
from jointwave.compare.runs.processes import ALONE, Processes
from jointwave.compare.runs.reuse import log_reading, signed
from jointwave.results.dataset import energy_residual, open_ledger
from jointwave.results.snapshots import snapshots_of

T = TypeVar("T")
STOPPED = ".stopped.nc"  # the end of the name of a partial result


class Done(NamedTuple):
    """One computed result. ledger : warning that the energy ledger does not close, or "".

    facts : machine-readable. `fragments` (pieces between broken joints) is None if no joint can
        break, `static_out_of_balance` without an initial static state. `fields` : files.
    """

    job: Job
    ledger: str
    facts: dict[str, Any]


def execute(
    jobs: list[Job],
    progress: Progress,
    processes: Processes = ALONE,
    settings: CheckpointSettings | None = None,
) -> list[Done]:
    """Run the jobs one after the other and write each result with its snapshots.

    processes : share the runs of the continuum. The first process does the other runs, writes all
        files, and alone returns the list.
    settings : checkpoint settings of the runs; None: no checkpoints.
    Raises SceneError if a run fails, its file cannot be written, or its checkpoint cannot be used;
    InterruptedRun if a signal has stopped a run.
    """
    settings = settings or CheckpointSettings(0.0, False, Signals())
    savers: list[Any] = [_shared(job, processes, partial(_saver, job, settings)) for job in jobs]
    done: list[Done] = []
    for i, (job, saver) in enumerate(zip(jobs, savers, strict=True)):

        def part(fraction: float, i: int = i) -> None:
            progress((i + fraction) / len(jobs))

        found = _shared(job, processes, partial(_run, job, saver, part))
        done += [found] if found else []
        part(1.0)
        if processes.is_first:
            settings.signals.act()
    return done


def _shared(job: Job, processes: Processes, work: Callable[[Processes], T]) -> T | None:
    """Return the result of `work` on the processes that share a job, None on the others."""
    if solver(job.name).shares:
        return work(processes)
    return processes.by_first(lambda: work(ALONE))


def _saver(job: Job, settings: CheckpointSettings, processes: Processes) -> RunCheckpointer:
    """Return the checkpointer of a job; raises SceneError if its result cannot be written."""
    if job.path.is_dir():
        raise SceneError(str(job.path), "", None, "is a folder, must be a file")
    if job.path.exists() and not os.access(job.path, os.W_OK):
        raise SceneError(str(job.path), "", None, "is write-protected")
    return RunCheckpointer(job.scene, job.name, job.path, settings, processes)


def _run(job: Job, saver: RunCheckpointer, progress: Progress, processes: Processes) -> Done | None:
    """Run a job unless its result exists, and write its files; the first process returns it."""
    result: Any = processes.by_first(saver.finished)
    if processes.told_by_first(lambda: result is None):
        work = partial(solve, job.name, job.scene, progress, processes.comm, saver)
        try:
            result, *cost = timings.timed(work)
        except StoppedError as error:
            processes.by_first(partial(_write_stopped, job, error))
            raise
        processes.by_first(lambda: _write(job, saver, result, *cost))
    elif result is not None:
        log_reading({job.path: result})
    return processes.by_first(lambda: _done(job, saver, result))


def _write_stopped(job: Job, error: StoppedError) -> None:
    """Write the partial result of a stopped run next to the path of its result."""
    result, error.result = error.result, None
    if result is None:
        return
    path = job.path.with_suffix(STOPPED)
    try:
        write_dataset(path, result)
    except OSError as problem:
        error.args = (f"{error}; {path} cannot be written: {problem.strerror}",)
    else:
        error.args = (f"{error}; what was computed is in {path}",)


def _write(
    job: Job, saver: RunCheckpointer, result: xr.Dataset, seconds: float, part: float
) -> None:
    """Write a result and save its cost; of a continued run, timed in part, estimate it instead."""
    if saver.done:
        samples = result.sizes["time"]
        result.attrs["seconds_stepping"] *= (samples - 1) / (samples - saver.done)
    write_dataset(job.path, signed(result, saver.signature, seconds))
    if saver.done:
        job.path.with_suffix(STOPPED).unlink(missing_ok=True)
    else:
        timings.note(job.name, job.scene, result.attrs, seconds, part)


def _done(job: Job, saver: RunCheckpointer, result: xr.Dataset) -> Done:
    """Write the snapshots of a result, remove its checkpoints, and return its facts."""
    has_ledger, fields = "energy" in result, list[str]()
    if job.scene.record.fields is not None and (found := snapshots_of(result)) is not None:
        fields.append(str(write_pvd(job.path.with_suffix(".pvd"), found)))
    facts = {
        "variant": job.scene.name,
        "engine": job.name,
        "steps": int(result.attrs.get("steps", 0)),
        "seconds_stepping": float(result.attrs.get("seconds_stepping", 0.0)),
        "energy_residual": energy_residual(result) if has_ledger else None,
        "file": str(job.path),
        "fragments": json.loads(result.attrs.get("fragments", "null")),
        "static_out_of_balance": result.attrs.get("static_out_of_balance"),
        "fields": fields,
    }
    done = Done(job, open_ledger(result) if has_ledger else "", facts)
    saver.files.remove()
    return done
