"""Commands that weigh accuracy against cost over many runs: effects, plan, study, report."""

from pathlib import Path
from typing import Annotated

import typer

from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    CORES,
    RESULTS,
    FreshOption,
    PrintOptions,
    SceneOptions,
    StrictOption,
    WorkersOption,
    command,
)
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.scenes import shipped


@command
def effects(
    asked: SceneOptions,
    shown: PrintOptions,
    out: Annotated[Path, typer.Option(help="Folder for table, diagram and points.")] = Path(
        "effects"
    ),
) -> None:
    """Measure what every effect of a scene costs and changes.

    For each effect this is its part of the time of a step, and the misfit of the result without it.
    The scene is a pillar, or a rock mass that rigid blocks can represent. Results are saved in DIR
    and not measured again.
    """
    from jointwave.compare.cli.study_view import run_and_show
    from jointwave.compare.studies.effects import experiment

    wanted = [(asked.scene, one) for one in asked.load(every=False)]
    one = experiment(wanted[0][1].title, wanted, out)
    run_and_show(one, out, CORES, shown)


@command
def plan(
    asked: SceneOptions,
    misfit: Annotated[
        float,
        typer.Option(min=0.0, help="Largest misfit, relative L2: 0.02 is 2 %."),
    ],
    seconds: Annotated[
        float | None,
        typer.Option(min=0.0, help="Limit of stepping, s: the best run within it."),
    ] = None,
) -> None:
    """Find the cheapest engine, elements and step that meet a misfit.

    Runs from the cheapest one on, until one meets the misfit, and prints the command for that run.
    """
    from jointwave.compare.cli.study_view import show_plan
    from jointwave.compare.studies import plan as plans

    for one in asked.load(every=False):
        with terminal.progress(one.name or one.title) as advance:
            found = plans.plan(one, misfit, seconds, advance)
        show_plan(found, asked.scene, asked.changes)


@command
def study(
    shown: PrintOptions,
    name: Annotated[
        str | None,
        typer.Argument(help="A shipped study or a study's TOML file."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for tables and points.")] = Path("studies"),
    workers: WorkersOption = CORES,
) -> None:
    """Run a study of accuracy against cost; without a name, list them.

    A scene is solved in many ways, each with its error and its cost, in a table and a diagram.
    Finished points are saved in DIR/NAME/ and not run again. Under mpiexec the processes share
    the points; those of a timed study are run one at a time. The study `stability` runs both
    engines on hard cases, each with a criterion from theory. `oblique-joint` compares reflection
    and transmission of P and SV waves at one joint with theory, `parallel-joints` at several.
    """
    from jointwave.compare.cli.study_view import run_and_show
    from jointwave.compare.studies import catalogue

    if name is None:
        found = catalogue.listed()
        terminal.print_json(found) if shown.as_json else terminal.show_facts({"studies": found})
        return
    one = catalogue.experiment(name, out)
    run_and_show(one, out / Path(name).stem, workers, shown)


@command
def report(
    shown: PrintOptions,
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE",
            help="Scene files or shipped scenes (default: the figures of Guo & Li (2002)).",
            autocompletion=shipped,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("report"),
    fresh: FreshOption = False,
    peers: Annotated[
        Path | None,
        typer.Option(help="Table of make bench-peers (default: out/peers/points.csv if present)."),
    ] = None,
    strict: StrictOption = False,
) -> None:
    """Write scenes, their figures, misfits and costs as one HTML page.

    The page needs no other file. Without a scene: the figures of Guo & Li (2002), the paper's
    claims, and all studies. Results are read from and stored in out/SCENE, points of studies in
    DIR.
    """
    for name in scenes or []:
        SceneOptions(name, strict=strict).load()
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.report.report import build, planned
    from jointwave.compare.runs.reuse import ResultFolder

    stored = ResultFolder(RESULTS, fresh)
    if shown.dry:
        runs, parts = planned(out, scenes or [], stored)
        show_forecasts(runs, shown.as_json, parts)
        return
    with (
        locked(out, out / "figures", out / "studies"),
        terminal.progress("report") as advance,
    ):
        found = build(out, advance, scenes=scenes or [], peers_table=peers, stored=stored)
    page, summary = found.page, found.summary
    if shown.as_json:
        rows, columns = summary.reset_index().values.tolist(), ["what", "pair", *summary]
        terminal.print_json({"page": str(found.file), "columns": columns, "rows": rows})
        return
    for sentence in page["lead"].values():
        terminal.say(sentence)
    if page["about"]:
        terminal.say(f"\n{page['about'].sentence}")
    terminal.say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    terminal.show_frame(summary)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        terminal.say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    terminal.say(f"report: {found.file}")
