"""Execution of the jobs of `jointwave run`, with checkpoints and complete files."""

import json
import os
from functools import partial
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.compare.engines import Progress, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.runs.checkpoint.resume import (
    CheckpointSettings,
    ResumableRun,
    result_of,
    resumable,
)
from jointwave.compare.runs.jobs import Job
from jointwave.compare.runs.output import write_dataset
from jointwave.compare.runs.processes import ALONE, Processes
from jointwave.results.dataset import energy_residual, open_ledger


class Done(NamedTuple):
    """One computed result with its cost.

    fragments : the pieces between broken joints, see `dem.fragments`; None if no joint can break.
    out_of_balance : force ratio of the static state at its start; None without one.
    ledger : the warning of an energy ledger that is open, "" where it closes.
    fields : the files that show its snapshots; empty without snapshots.
    """

    job: Job
    steps: int
    seconds: float
    residual: float | None
    ledger: str
    fragments: list[dict] | None
    out_of_balance: float | None
    fields: list[Path]


def execute(
    jobs: list[Job],
    progress: Progress,
    vtx: bool = False,
    processes: Processes = ALONE,
    settings: CheckpointSettings | None = None,
) -> list[Done]:
    """Run the jobs one after the other and write each result; `vtx`: snapshots as VTX too.

    processes : share the runs of the continuum. The first of them does the other runs, writes all
        files, and is the only one to return what was done.
    settings : checkpoint settings of the runs; None: no checkpoints.
    Raises SceneError if a run fails, its file or a VTX file cannot be written, or its checkpoint
    cannot be used; InterruptedRun if a signal has stopped a run.
    """
    done: list[Done] = []
    if vtx:
        _refuse_vtx(jobs)
    watches = [_resumable(job, settings, processes) for job in jobs]

    def part_of(i: int) -> Progress:
        return lambda fraction: progress((i + fraction) / len(jobs))

    for i, (job, watched) in enumerate(zip(jobs, watches, strict=True)):
        done += _made(job, watched, part_of(i), vtx, processes)
        progress((i + 1) / len(jobs))
        if settings is not None and processes.is_first:
            settings.signals.act()
    return done


def _resumable(
    job: Job, settings: CheckpointSettings | None, processes: Processes
) -> ResumableRun | None:
    """Return the checkpoints of a job on the processes that share it, None on others.

    Raises SceneError if its result could not be written in the end.
    """

    def by(who: Processes) -> ResumableRun:
        if job.path.is_dir():
            raise SceneError(str(job.path), "", None, "is a folder, must be a file")
        if job.path.exists() and not os.access(job.path, os.W_OK):
            raise SceneError(str(job.path), "", None, "is write-protected")
        return resumable(job.scene, job.name, job.path, settings, who)

    return by(processes) if _is_shared(job) else processes.by_first(lambda: by(ALONE))


def _is_shared(job: Job) -> bool:
    """Return whether several processes run a job together."""
    return solver(job.name).shares


def _made(
    job: Job, watched: ResumableRun | None, progress: Progress, vtx: bool, processes: Processes
) -> list[Done]:
    """Run a job and write its result; return what was done, empty except on the first process."""
    if watched is None:  # only the first process runs it
        done = processes.by_first(lambda: None)
    elif watched.is_made:
        done = processes.by_first(lambda: _finished(job, watched, vtx))
    elif _is_shared(job):
        result = _run(job, watched, progress, processes)
        done = processes.by_first(lambda: _written(job, watched, result, vtx))
    else:
        done = processes.by_first(
            lambda: _written(job, watched, _run(job, watched, progress, ALONE), vtx)
        )
    return [] if done is None else [done]


def _run(job: Job, watched: ResumableRun, progress: Progress, processes: Processes) -> xr.Dataset:
    try:
        return solve(job.name, job.scene, progress, processes.comm, watched.keeper)
    except StoppedError as error:
        processes.by_first(partial(_keep, job, error))
        raise


def _keep(job: Job, error: StoppedError) -> None:
    """Write the partial result of a stopped run, beside the path of its result."""
    result, error.result = error.result, None
    if result is None:
        return
    path = _stopped(job)
    try:
        write_dataset(path, result)
    except OSError as problem:
        error.args = (f"{error}; {path} cannot be written: {problem.strerror}",)
    else:
        error.args = (f"{error}; what was computed is in {path}",)


def _stopped(job: Job) -> Path:
    return job.path.with_suffix(".stopped.nc")


def _written(job: Job, watched: ResumableRun, result: xr.Dataset, vtx: bool) -> Done:
    """Write a result with its snapshots and remove the run's checkpoints."""
    signed = watched.signed(result)
    write_dataset(job.path, signed)
    if watched.keeper is not None and watched.keeper.done:
        _stopped(job).unlink(missing_ok=True)
    else:
        timings.note(job.name, job.scene, result.attrs)
    return _finished(job, watched, vtx, signed)


def _finished(job: Job, watched: ResumableRun, vtx: bool, result: xr.Dataset | None = None) -> Done:
    """Write the snapshots of a result, by default that of an earlier command."""
    if result is None:
        result = result_of(job.path, watched.signature)
        if result is None:
            raise SceneError(str(job.path), "", None, "has changed since this command started")
    done = Done(
        job,
        int(result.attrs.get("steps", 0)),
        float(result.attrs.get("seconds_stepping", 0.0)),
        *_residual(result),
        json.loads(result.attrs.get("fragments", "null")),
        result.attrs.get("static_out_of_balance"),
        _write_snapshots(job, result, vtx),
    )
    watched.checkpoints.remove()
    return done


def _refuse_vtx(jobs: list[Job]) -> None:
    from jointwave.compare.runs.field_files import refuse_vtx

    for job in jobs:
        if job.scene.record.fields is None:
            raise SceneError(job.scene.where, "record.fields", None, "is required by --vtx")
    refuse_vtx()


def _write_snapshots(job: Job, result: xr.Dataset, vtx: bool) -> list[Path]:
    """Write a result's snapshots, if any, beside it; return the files to open."""
    if job.scene.record.fields is None:
        return []
    from jointwave.compare.runs.field_files import write_pvd, write_vtx
    from jointwave.results.snapshots import snapshots_of

    found = snapshots_of(result)
    if found is None:
        return []
    files = [write_pvd(job.path.with_suffix(".pvd"), found)]
    return [*files, write_vtx(job.path.with_suffix(".bp"), found)] if vtx else files


def _residual(result: xr.Dataset) -> tuple[float | None, str]:
    """Return how far the energy ledger of a result is open, over the work, and its warning."""
    return (energy_residual(result), open_ledger(result)) if "energy" in result else (None, "")
