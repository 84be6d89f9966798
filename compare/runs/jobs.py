"""Jobs of `jointwave run`, one per result; all are checked before the first runs."""

from itertools import chain, product
from pathlib import Path
from typing import Any, NamedTuple

from jointwave.cases.errors import SceneError, nearest
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, applies, selection, solver
from jointwave.compare.solvers.record import Solver


class Job(NamedTuple):
    """One result to compute: the scene, its solver, and the file."""

    scene: AnyScene
    name: str
    path: Path


def wanted(engines: list[str], models: list[str]) -> list[tuple[str, str | None]]:
    """Return (engine, model) for each requested run; the model None means all that apply."""
    known = selection()
    chosen: dict[str, list[Any]] = {e: [m for m in models if m in known[e]] for e in engines}
    if left := [m for m in models if m not in chain(*chosen.values())]:
        fitting = [engine for engine, of in known.items() if left[0] in of]
        every = [model for of in known.values() for model in of if model]
        one_of = f"must be one of {', '.join(every)}{nearest(left[0], every)}"
        allowed = f"needs --engine {fitting[0]}" if fitting else one_of
        raise SceneError("--model", left[0], None, allowed)
    found = ((engine, m) for engine, mine in chosen.items() for m in mine or [None])
    return list(dict.fromkeys(found))


def engine_of(model: str) -> str:
    """Return the --engine of a model; for an unknown model that of the exact solutions."""
    return next((one for one, models in selection().items() if model in models), Solver.engine)


def options_of(name: str) -> list[str]:
    """Return the options that select an engine or exact solution."""
    of = solver(name)
    model = name if of.exact else of.model
    return ["--engine", of.engine, *(["--model", model] if model else [])]


def plan(
    scenes: list[AnyScene], runs: list[tuple[str, str | None]], out: Path
) -> tuple[list[Job], list[SceneError]]:
    """Return the jobs, and errors that say why an engine does not solve a variant.

    Raises SceneError before any run if there is no job, or if a result would replace another file.
    """
    from jointwave.compare.runs.output import refuse_foreign

    jobs: list[Job] = []
    left_out: list[SceneError] = []
    for scene, run in product(scenes, runs):
        try:
            names = names_of(*run, scene)
        except SceneError as error:
            left_out.append(error)
        else:
            jobs += [Job(scene, name, result_path(out, scene, name)) for name in names]
    if not jobs:
        raise left_out[0]
    for job in jobs:
        refuse_foreign(job.path)
    return jobs, left_out


def result_path(out: Path, scene: AnyScene, name: str, suffix: str = "") -> Path:
    """Return the file of a solver's result, in a folder for the variant if it has a name."""
    file = name if name in ENGINES else f"{solver(name).engine}-{name}"
    return out / scene.name / f"{file}{suffix}.nc"


def names_of(engine: str, model: str | None, scene: AnyScene) -> list[str]:
    """Return the solvers of a scene for an engine and a model; None: all models that apply.

    Raises SceneError if none does.
    """
    every = selection()[engine]
    if model is not None:
        return [every[model]]
    found = [name for name in every.values() if applies(name, scene)]
    if not found:
        reason = applies(next(iter(every.values())), scene).reason
        raise SceneError(scene.name or scene.title, "", None, f"no {engine}: {reason}")
    return found
