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
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    CORES,
    DryOption,
    Engine,
    EngineOption,
    EnsembleOption,
    JsonOption,
    ModelOption,
    OutOption,
    SceneArgument,
    SetOption,
    StrictOption,
    SweepOption,
    VariantOption,
    WorkersOption,
    app,
    load,
)
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.checkpoint.signals import watched
from jointwave.compare.runs.processes import started
from jointwave.compare.scenes import find, shipped
from jointwave.compare.solvers.dem import DEM


@app.command("list")
def list_scenes(as_json: JsonOption = False) -> None:
    """List the shipped scenes and their variants."""
    facts: list[dict[str, Any]] = [
        {"scene": name, "title": scenes[0].title, "variants": [one.name for one in scenes[1:]]}
        for name, scenes in ((name, cases.load(find(name))) for name in shipped())
    ]
    if as_json:
        terminal.print_json(facts)
    else:
        terminal.show_facts({"scenes": facts})


@app.command()
def run(
    scene: SceneArgument,
    engine: EngineOption = [Engine(DEM.engine)],
    model: ModelOption = None,
    changes: SetOption = [],
    variant: VariantOption = None,
    swept: SweepOption = [],
    members: EnsembleOption = 0,
    out: OutOption = Path("results"),
    every: Annotated[
        float,
        typer.Option(
            "--checkpoint-every",
            metavar="SECONDS",
            min=0.0,
            help="Of wall time; 0: no checkpoints.",
        ),
    ] = 60.0,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted run from its checkpoint.")
    ] = False,
    workers: WorkersOption = CORES,
    dry: DryOption = False,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Simulate a scene and write each result as DIR/[variant/]ENGINE[-MODEL].nc.

    With record.fields also its snapshots, as a .pvd file for ParaView. Under mpiexec the processes
    share each run of the continuum; everything else is done by the first of them.

    With --resume a killed run continues from its last checkpoint, with a bit-identical result;
    complete results are kept. Ctrl-C saves the partial result.

    --sweep runs every value of a key, DIR/KEY=VALUE/... each, in several processes; finished
    points are not run again, failed ones are listed. --ensemble does so for every member of a
    scene with random joints.
    """
    from jointwave.compare.cli import run_view
    from jointwave.compare.runs import jobs
    from jointwave.compare.runs import run as runs
    from jointwave.compare.runs.checkpoint.resume import CheckpointSettings

    wanted = jobs.wanted([e.value for e in engine], model or [])
    if swept or members:
        from jointwave.compare.cli.study_view import sweep
        from jointwave.compare.studies.sweep import run_scene, sweep_of

        cases_of = sweep_of(scene, changes, variant, swept, out, members)
        work = partial(run_scene, runs=wanted)

        def runs_of(one: AnyScene) -> list[tuple[str, AnyScene, str]]:
            return [("", job.scene, job.name) for job in jobs.plan([one], wanted, out)]

        sweep(cases_of, work, runs_of, workers, dry, as_json, strict)
        return
    scenes = load(scene, changes, variant, strict)
    asked = jobs.plan(scenes, wanted, out)
    if dry:
        from jointwave.compare.cli.forecast_view import show_forecasts

        show_forecasts([("", job.scene, job.name) for job in asked], as_json)
        return
    processes = started()
    folders = {job.path.parent for job in asked}
    settings = CheckpointSettings(every, resume, watched())
    with ExitStack() as held, terminal.progress(f"{len(asked)} runs") as advance:
        processes.by_first(lambda: held.enter_context(locked(out, *folders)))
        done = runs.execute(asked, advance, processes, settings)
    processes.by_first(lambda: run_view.show_runs(done, as_json))


@app.command()
def explain(
    scene: SceneArgument,
    changes: SetOption = [],
    variant: VariantOption = None,
    strict: StrictOption = False,
    measured: Annotated[
        bool,
        typer.Option("--measure", help="Time a rigid block's step; may compile a minute."),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Print the effects of a scene, its critical steps, the exact solutions that apply, and the
    reference; for a rock mass also its blocks."""
    from jointwave.compare.cli.explain import explanation, show_explanation

    for one in load(scene, changes, variant or "", strict):
        (terminal.print_json if as_json else show_explanation)(explanation(one, measured))
