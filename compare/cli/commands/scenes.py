"""Commands about one scene: what it is, its runs, and how far apart its solutions are.

Heavy packages are imported by the command that needs them, so a run of the rigid blocks starts
without dolfinx and matplotlib.
"""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    Engine,
    EngineOption,
    FreshOption,
    JsonOption,
    ModelOption,
    PrintOptions,
    SceneOptions,
    SweepOptions,
    app,
    command,
    results_of,
    warn,
)
from jointwave.compare.engines import label_of
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.checkpoint.signals import watched
from jointwave.compare.runs.processes import started
from jointwave.compare.scenes import find, shipped
from jointwave.compare.solvers.dem import DEM

LABELS = {"from_y": "from (m)", "to_y": "to (m)", "mass": "mass (kg)", "velocity": "velocity (m/s)"}
LABELS |= {"seconds_stepping": "stepping (s)", "energy_residual": "energy residual (of the work)"}
TOLD_BELOW = ("fragments", "static_out_of_balance", "fields")


@app.command("list")
def list_scenes(as_json: JsonOption = False) -> None:
    """List the shipped scenes and their variants."""
    facts: list[dict[str, Any]] = [
        {
            "scene": name,
            "title": scenes[0].title,
            "variants": [one.name for one in scenes[1:]],
        }
        for name, scenes in ((name, cases.load(find(name))) for name in shipped())
    ]
    if as_json:
        terminal.print_json(facts)
        return
    for one in facts:
        terminal.say_wrapped(f"{one['scene']}: {one['title']}", " " * 4)
        if one["variants"]:
            terminal.say_wrapped(f"    variants: {'; '.join(one['variants'])}", " " * 6)


@command
def run(
    asked: SceneOptions,
    sweeps: SweepOptions,
    shown: PrintOptions,
    engine: EngineOption = [Engine(DEM.engine)],
    model: ModelOption = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for results (default: out/SCENE).")
    ] = None,
    every: Annotated[
        float,
        typer.Option(
            "--checkpoint-every",
            metavar="SECONDS",
            min=0.0,
            help="Time between two checkpoints; 0: none.",
        ),
    ] = 60.0,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted run from its checkpoint.")
    ] = False,
    fresh: FreshOption = False,
) -> None:
    """Simulate a scene and write its results as NetCDF files.

    The files are DIR/[variant/]ENGINE[-MODEL].nc. With record.fields, snapshots are written as
    well, as a .pvd file for ParaView. Under mpiexec the processes share each run of the
    continuum; the first process does everything else.

    Results that are stored already are read; --fresh computes them again. With --resume a killed
    run continues from its last checkpoint, with a bit-identical result. Ctrl-C saves the partial
    result.

    --sweep runs the scene for every value of a key, each in DIR/KEY=VALUE/, in several
    processes. Finished points are not run again; failed ones are listed. --ensemble runs a
    scene with random joints for several seeds.
    """
    from jointwave.compare.runs import jobs
    from jointwave.compare.runs import run as runs
    from jointwave.compare.runs.checkpoint.resume import CheckpointSettings

    if fresh and resume:
        allowed = "computes anew what --resume would continue: give one of them"
        raise SceneError("--fresh", "", None, allowed)
    out = results_of(asked.scene, out)
    wanted = jobs.wanted([e.value for e in engine], model or [])
    if sweeps.swept or sweeps.members:
        from jointwave.compare.cli.study_view import sweep
        from jointwave.compare.studies.sweep import run_scene

        def solvers(one: AnyScene) -> list[str]:
            return [job.name for job in jobs.plan([one], wanted, out)[0]]

        work = partial(run_scene, runs=wanted)
        sweep(asked, sweeps, out, fresh, lambda _: work, solvers, shown)
        return
    scenes = asked.load()
    todo, left_out = jobs.plan(scenes, wanted, out)
    warn(scenes[:1], asked.strict, lambda _: map(str, left_out))
    if shown.dry:
        from jointwave.compare.cli.forecast_view import show_forecasts
        from jointwave.compare.runs.reuse import ResultFolder
        from jointwave.compare.studies.forecast import runs_of

        stored = ResultFolder(out, fresh)
        found = [run for job in todo for run in runs_of([job.name], job.scene, stored)]
        show_forecasts([run._replace(for_paraview=True) for run in found], shown.as_json)
        return
    processes = started()
    folders = {job.path.parent for job in todo}
    settings = CheckpointSettings(every, resume, watched(), fresh)
    with ExitStack() as held, terminal.progress(f"{len(todo)} runs") as advance:
        processes.by_first(lambda: held.enter_context(locked(out, *folders)))
        done = runs.execute(todo, advance, processes, settings)
    processes.by_first(lambda: show_runs(done, shown.as_json))


def show_runs(done: list[Any], as_json: bool) -> None:
    """Print what was run, what it cost and where it is; done : `runs.run.Done`."""
    terminal.say_warnings(f"{d.job.scene.name}: {d.ledger}".lstrip(": ") for d in done if d.ledger)
    if as_json:
        terminal.print_json([one.facts for one in done])
        return
    facts = [one.facts | {"engine": label_of(one.job.name)} for one in done]
    rows = [{key: x for key, x in one.items() if key not in TOLD_BELOW} for one in facts]
    terminal.show_facts({"runs": rows}, LABELS)
    for one in done:
        name, pieces = one.job.scene.name or label_of(one.job.name), one.facts["fragments"]
        if (ratio := one.facts["static_out_of_balance"]) is not None:
            terminal.say(f"{name}: starts at rest, out-of-balance force ratio {ratio:.1e}")
        if pieces is not None:
            terminal.say(f"{name}: {len(pieces) - 1 or 'no'} joints broke")
            terminal.show_facts({"fragments": pieces[1:] and pieces}, LABELS)
        for path in one.facts["fields"]:
            terminal.say(f"{name}: snapshots for ParaView, {path}")
        if one.job.scene.record.fields is not None and not one.facts["fields"]:
            terminal.say(f"{name}: no snapshots: the solution is known at the receivers only")


@command
def explain(
    asked: SceneOptions,
    every: Annotated[
        bool,
        typer.Option("--all", help="Also absent effects and solutions that do not apply, and why."),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Print what a scene has, its time steps, and what can solve it.

    These are its rock and its blocks, the waves that enter, the active effects, the step of each
    engine and what limits it, the solutions that apply with the options that select them, and the
    reference of each engine. Nothing is run.
    """
    from jointwave.compare.cli.explain import explanation
    from jointwave.compare.cli.explain_view import show_explanation

    for one in asked.load(every=False):
        found = explanation(one)
        terminal.print_json(found) if as_json else show_explanation(found, every)
