"""Commands that weigh accuracy against cost over many runs: effects, plan, study, report."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    CORES,
    RESULTS,
    DryOption,
    FreshOption,
    JsonOption,
    OutOption,
    SceneArgument,
    SetOption,
    StrictOption,
    VariantOption,
    WorkersOption,
    app,
    load,
)
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.scenes import shipped


@app.command()
def effects(
    scene: SceneArgument,
    changes: SetOption = [],
    variant: VariantOption = None,
    out: Annotated[Path, typer.Option(help="Folder for table, diagram and points.")] = Path(
        "effects"
    ),
    dry: DryOption = False,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Measure what every effect of a scene costs and changes.

    For each effect this is its part of the time of a step, and the misfit of the result without it.
    The scene is a pillar, or a rock mass that rigid blocks can represent. Results are saved in DIR
    and not measured again.
    """
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.cli.study_view import run_and_show
    from jointwave.compare.studies.effects import Variant, planned, run
    from jointwave.compare.studies.effects_summary import summarise

    wanted = [Variant(scene, one) for one in load(scene, changes, variant or "", strict)]
    if dry:
        show_forecasts(planned(wanted, out), as_json, {"diagrams": 1})
        return
    run_and_show(
        wanted[0].scene.title,
        out,
        1,
        lambda pool, advance: summarise(out, run(wanted, out, advance)),
        as_json,
    )


@app.command()
def plan(
    scene: SceneArgument,
    misfit: Annotated[
        float,
        typer.Option(min=0.0, help="Largest misfit, relative L2: 0.02 is 2 %."),
    ],
    seconds: Annotated[
        float | None,
        typer.Option(min=0.0, help="Limit of stepping, s: the best run within it."),
    ] = None,
    changes: SetOption = [],
    variant: VariantOption = None,
    strict: StrictOption = False,
) -> None:
    """Find the cheapest engine, elements and step that meet a misfit.

    Runs from the cheapest one on, until one meets the misfit, and prints the command for that run.
    """
    scenes = load(scene, changes, variant or "", strict)
    from jointwave.compare.cli.plan_view import show_plan
    from jointwave.compare.studies import plan as plans

    for one in scenes:
        with terminal.progress(one.name or one.title) as advance:
            found = plans.plan(one, misfit, seconds, advance)
        show_plan(found, scene, changes)


@app.command()
def study(
    name: Annotated[
        str | None,
        typer.Argument(help="A shipped study or a study's TOML file."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for tables and points.")] = Path("studies"),
    workers: WorkersOption = CORES,
    dry: DryOption = False,
    as_json: JsonOption = False,
) -> None:
    """Run a study of accuracy against cost; without a name, list them.

    A scene is solved in many ways, each with its error and its cost, in a table and a diagram.
    Finished points are saved in DIR/NAME/ and not run again. Under mpiexec the processes share
    the points; those of a timed study are run one at a time. The study `stability` runs both
    engines on hard cases, each with a criterion from theory. `oblique-joint` compares reflection
    and transmission of P and SV waves at one joint with theory, `parallel-joints` at several.
    """
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.cli.study_view import run_and_show, show_studies

    if name is None:
        show_studies(as_json)
        return
    folder = out / Path(name).stem
    shared = workers > 1
    work: Callable[[Any, Any], Any]
    runs: Callable[[], list[Any]]
    if name == "stability":
        from jointwave.compare.studies import hard_cases as hard

        title, work = hard.TITLE, lambda pool, tell: hard.make_study(out, pool, progress=tell)
        runs = partial(hard.planned, out)
    elif name in ("oblique-joint", "parallel-joints"):
        from jointwave.compare.studies.scattering import TITLES, planned
        from jointwave.compare.studies.scattering_summary import make_study

        title, work = TITLES[name], lambda pool, tell: make_study(name, out, tell, pool=pool)
        runs = partial(planned, name, folder)
    else:
        from jointwave.compare.studies.study import load
        from jointwave.compare.studies.work_precision import planned as planned_points
        from jointwave.compare.studies.work_precision import run, summarise

        asked = load(name)
        shared = shared and not asked.timed
        title, work = (
            asked.title,
            lambda pool, tell: summarise(out, folder.name, asked, run(asked, folder, pool, tell)),
        )
        runs = partial(planned_points, asked, folder)

    if dry:
        show_forecasts(runs(), as_json, {"diagrams": 1, "processes": workers * shared})
        return
    run_and_show(title, folder, workers, work, as_json)


@app.command()
def report(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE",
            help="Scene files or shipped scenes (default: the figures of Guo & Li (2002)).",
            autocompletion=shipped,
        ),
    ] = None,
    out: OutOption = Path("report"),
    fresh: FreshOption = False,
    dry: DryOption = False,
    peers: Annotated[
        Path | None,
        typer.Option(help="Table of make bench-peers (default: out/peers/points.csv if present)."),
    ] = None,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Write scenes, their figures, misfits and costs as one HTML page.

    The page needs no other file. Without a scene: the figures of Guo & Li (2002), the paper's
    claims, and all studies. Results are read from and stored in out/SCENE, points of studies in
    DIR.
    """
    for name in scenes or []:
        load(name, [], None, strict)
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.cli.frames import show_frame
    from jointwave.compare.report.report import build, planned
    from jointwave.compare.runs.reuse import ResultFolder

    stored = ResultFolder(RESULTS, fresh)
    if dry:
        runs, parts = planned(out, scenes or [], stored)
        show_forecasts(runs, as_json, parts)
        return
    with (
        locked(out, out / "figures", out / "studies"),
        terminal.progress("report") as advance,
    ):
        found = build(out, advance, scenes=scenes or [], peers_table=peers, stored=stored)
    page, summary = found.page, found.summary
    if as_json:
        rows, columns = summary.reset_index().values.tolist(), ["what", "pair", *summary]
        terminal.print_json({"page": str(found.file), "columns": columns, "rows": rows})
        return
    for sentence in page["lead"].values():
        terminal.say(sentence)
    if page["about"]:
        terminal.say(f"\n{page['about'].sentence}")
    terminal.say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    show_frame(summary)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        terminal.say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    terminal.say(f"report: {found.file}")
