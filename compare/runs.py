"""The runs that `jointwave run` was asked for: checked first, then executed, each file whole."""

import json
from functools import partial
from pathlib import Path
from typing import NamedTuple

from cases.errors import SceneError, StoppedError
from cases.result import Fields, imbalance
from cases.scene import Scene
from compare.engines import Progress, applies, exact_names, solve
from compare.output import fields_of, refuse_foreign, write_fields
from compare.processes import ALONE, Processes

CONTINUUM_MODELS = ("jointed", "equivalent")


class Job(NamedTuple):
    """One result to be made: the scene, what solves it, and its file."""

    scene: Scene
    name: str
    path: Path


class Done(NamedTuple):
    """One result that was made, with what it cost.

    fragments : the pieces between broken joints, see `dem.fragments`; None where none can break.
    out_of_balance : force ratio of the static state that it started from; None where from none.
    fields : the files that show its snapshots; none where it has no snapshots.
    """

    job: Job
    steps: int
    seconds: float
    residual: float | None
    fragments: list[dict] | None
    out_of_balance: float | None
    fields: list[Path]


def wanted(engines: list[str], models: list[str]) -> list[tuple[str, str | None]]:
    """Return (engine, model) for each run asked for; the model None stands for all that apply."""
    known = {"dem": (), "continuum": CONTINUUM_MODELS}
    found: list[tuple[str, str | None]] = []
    left = list(models)
    for engine in engines:
        allowed = known[engine] if engine in known else exact_names()
        mine = [m for m in models if m in allowed]
        left = [m for m in left if m not in mine]
        found += [(engine, m) for m in mine] or [(engine, None)]
    if left:
        options = [*CONTINUUM_MODELS, *exact_names()]
        allowed_text = f"must be a model of a chosen --engine: {', '.join(options)}"
        raise SceneError("--model", left[0], None, allowed_text)
    return found


def plan(scenes: list[Scene], runs: list[tuple[str, str | None]], out: Path) -> list[Job]:
    """Return the jobs, all of which apply; raises SceneError before anything is run, also where a
    file that is no result stands in the place of one."""
    jobs = []
    for scene in scenes:
        folder = out / scene.name if scene.name else out
        for engine, model in runs:
            for name in _names(engine, model, scene):
                file = name if engine != "exact" else f"exact-{name}"
                refuse_foreign(folder / f"{file}.nc")
                jobs.append(Job(scene, name, folder / f"{file}.nc"))
    return jobs


def execute(
    jobs: list[Job], progress: Progress, vtx: bool = False, processes: Processes = ALONE
) -> list[Done]:
    """Run the jobs one after the other and write each result; `vtx`: snapshots as VTX too.

    processes : share the runs of the continuum. The first of them makes the others, writes all
    files, and alone returns what was done.
    Raises SceneError where a run cannot be made, or no VTX file be written.
    """
    done: list[Done] = []
    if vtx:
        _refuse_vtx(jobs)

    def part_of(i: int) -> Progress:
        return lambda fraction: progress((i + fraction) / len(jobs))

    for i, job in enumerate(jobs):
        done += _made(job, part_of(i), vtx, processes)
        progress((i + 1) / len(jobs))
    return done


def _made(job: Job, progress: Progress, vtx: bool, processes: Processes) -> list[Done]:
    """Run a job and write its result; return what was done, nothing but on the first process."""
    if job.name.startswith("continuum-"):
        try:
            result = _solve(job, progress, processes.comm)
        except StoppedError as error:
            processes.by_first(partial(_keep, job, error))
            raise
        done = processes.by_first(lambda: _written(job, result, vtx))
    else:
        done = processes.by_first(lambda: _written(job, _solve(job, progress), vtx))
    return [] if done is None else [done]


def _keep(job: Job, error: StoppedError) -> None:
    """Write what a run had computed when it stopped, beside where its result would be."""
    if error.result is not None:
        path = job.path.with_suffix(".stopped.nc")
        write_fields(path, fields_of(error.result))
        error.args = (f"{error}; what was computed is in {path}",)


def _written(job: Job, result: Fields, vtx: bool) -> Done:
    """Write a result with its snapshots."""
    write_fields(job.path, result)
    return Done(
        job,
        int(result.attributes.get("steps", 0)),
        float(result.attributes.get("seconds_stepping", 0.0)),
        _residual(result),
        _fragments(result),
        result.attributes.get("static_out_of_balance"),
        _write_snapshots(job, result, vtx),
    )


def _refuse_vtx(jobs: list[Job]) -> None:
    from compare.fieldfiles import refuse_vtx

    for job in jobs:
        if job.scene.record.fields is None:
            raise SceneError(job.scene.where, "record.fields", None, "is required by --vtx")
    refuse_vtx()


def _write_snapshots(job: Job, result: Fields, vtx: bool) -> list[Path]:
    """Write a result's snapshots beside it, where it has any; return the files to open."""
    if job.scene.record.fields is None:
        return []
    from cases.snapshots import snapshots_of
    from compare.fieldfiles import write_pvd, write_vtx

    found = snapshots_of(result)
    if found is None:
        return []
    files = [write_pvd(job.path.with_suffix(".pvd"), found)]
    return [*files, write_vtx(job.path.with_suffix(".bp"), found)] if vtx else files


def _fragments(result: Fields) -> list[dict] | None:
    text = result.attributes.get("fragments")
    return None if text is None else json.loads(text)


def _residual(result: Fields) -> float | None:
    if "energy" not in result.variables:
        return None
    terms = {**result.variables, **result.coords}["term"][1]
    return imbalance(result.variables["energy"][1], terms.tolist())


def _solve(job: Job, progress: Progress, comm=None) -> Fields:
    if job.name == "dem":
        from dem import simulate_fields

        return simulate_fields(job.scene, progress)
    return fields_of(solve(job.name, job.scene, progress, comm))


def _names(engine: str, model: str | None, scene: Scene) -> list[str]:
    if engine == "dem":
        return ["dem"]
    every = (
        [f"continuum-{m}" for m in CONTINUUM_MODELS]
        if engine == "continuum"
        else list(exact_names())
    )
    if model is not None:
        return [f"continuum-{model}" if engine == "continuum" else model]
    found = [name for name in every if applies(name, scene)]
    if not found:
        raise SceneError(scene.title, "", None, f"no {engine}: {applies(every[0], scene).reason}")
    return found
