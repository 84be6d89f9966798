"""What `jointwave run` is asked for, as jobs: one for each result, all of which can be made."""

from pathlib import Path
from typing import NamedTuple

from cases.errors import SceneError
from cases.schema.scene import Scene
from compare.engines import applies, exact_names
from compare.runs.output import refuse_foreign

CONTINUUM_MODELS = ("jointed", "equivalent")


class Job(NamedTuple):
    """One result to be made: the scene, what solves it, and its file."""

    scene: Scene
    name: str
    path: Path


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
            for name in names_of(engine, model, scene):
                file = name if engine != "exact" else f"exact-{name}"
                refuse_foreign(folder / f"{file}.nc")
                jobs.append(Job(scene, name, folder / f"{file}.nc"))
    return jobs


def names_of(engine: str, model: str | None, scene: Scene) -> list[str]:
    """Return what solves a scene for an engine and model; the model None: all that apply.

    Raises SceneError where none does.
    """
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
