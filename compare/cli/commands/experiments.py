"""Commands that weigh accuracy against cost over many runs: effects, plan, study, report."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any

import typer

from cases.errors import SceneError
from compare.cli import completion
from compare.cli.options import (
    CORES,
    DryOption,
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
from compare.runs.checkpoint.lock import locked
from compare.runs.processes import started


@app.command()
def effects(
    scene: Annotated[
        str | None,
        typer.Argument(
            help="A scene file or a shipped scene; absent: all that are shipped.",
            autocompletion=completion.scenes,
        ),
    ] = None,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    out: Annotated[Path, typer.Option(help="Folder for table, diagram and points.")] = Path(
        "effects"
    ),
    workers: WorkersOption = CORES,
    dry: DryOption = False,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Say what every effect of a scene costs, and how far the answer is without it.

    Without a scene: of every variant of every shipped scene. That takes a while; what is done is
    kept in DIR and not run again.
    """
    from compare.cli import terminal
    from compare.experiments.ablation import runner as ablation_runs
    from compare.experiments.ablation import show as ablation_view
    from compare.experiments.ablation.section import write_section
    from compare.experiments.pool import on_pool

    wanted = _cases(scene, changes, variant, strict)
    if dry:
        from compare.experiments.cost import dry_run

        dry_run.show_effects(wanted, out, as_json)
        return
    with locked(out), terminal.progress(f"effects of {len(wanted)} variants") as advance:
        found = on_pool(
            started(), workers, lambda pool: ablation_runs.run(wanted, out, pool, advance)
        )
    assert found is not None  # one process only: see root
    section = write_section(out, found)
    ablation_view.show_balances(found, section, as_json)


@app.command()
def plan(
    scene: SceneArgument,
    misfit: Annotated[float, typer.Option(min=0.0, help="Relative L2, from the finest physics.")],
    seconds: Annotated[
        float | None, typer.Option(min=0.0, help="At most so long a run, the best within it.")
    ] = None,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find the cheapest engine, elements and step that meet a misfit, by a few cheap runs."""
    scenes = load(scene, changes, variant if variant is not None else "", strict)
    from compare.cli import terminal
    from compare.experiments.planner import planner
    from compare.experiments.planner import show as plan_view

    found = []
    for one in scenes:
        with terminal.progress(one.name or one.title) as advance:
            found.append(planner.plan(one, misfit, seconds, advance))
    plan_view.show_plans(found, misfit, as_json)


@app.command()
def study(
    name: Annotated[
        str,
        typer.Argument(
            help="A shipped study or a study's TOML file.", autocompletion=completion.studies
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder for tables and points.")] = Path("studies"),
    workers: WorkersOption = CORES,
    dry: DryOption = False,
    as_json: JsonOption = False,
) -> None:
    """Run a study: a scene solved in many ways, each with its error and its cost, as one table
    and its diagram.

    Points that are done are kept in DIR/NAME/ and not run again. Under mpiexec the processes share
    the points; those of a timed study are run one at a time. The study `stability` puts both
    engines to hard cases, each with a criterion from theory.
    """
    if dry:
        from compare.experiments.cost import dry_run

        dry_run.show_study(name, out, as_json)
        return
    if name == "stability":
        _study_stability(out, workers, as_json)
        return
    from compare.cli import terminal
    from compare.experiments.pool import on_pool
    from compare.experiments.study.diagram import write_diagram
    from compare.experiments.study.runner import run as run_points
    from compare.experiments.study.show import show_study
    from compare.experiments.study.study import load
    from compare.experiments.study.table import write_table

    asked, stem, processes = load(name), Path(name).stem, started()
    with ExitStack() as held, terminal.progress(asked.title) as advance:
        processes.by_first(lambda: held.enter_context(locked(out / stem)))
        rows = on_pool(
            processes, workers, lambda pool: run_points(asked, out / stem, pool, advance)
        )
    if rows is not None:
        files = (*write_table(out, stem, asked, rows), *write_diagram(out, stem, asked, rows))
        show_study(asked, rows, files, as_json)


def _study_stability(out: Path, workers: int, as_json: bool) -> None:
    from compare.cli import terminal
    from compare.experiments.pool import on_pool
    from compare.experiments.robustness.section import TITLE, make_study
    from compare.experiments.robustness.show import show

    with terminal.progress(TITLE) as advance:
        found = on_pool(started(), workers, lambda pool: make_study(out, pool, progress=advance))
    if found is not None:
        show(found, as_json)


@app.command()
def report(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE",
            help="Scene files or shipped scenes; absent: the figures of Guo & Li (2002).",
            autocompletion=completion.scenes,
        ),
    ] = None,
    out: OutOption = Path("report"),
    peers: Annotated[
        Path | None,
        typer.Option(help="Table of make bench-peers; absent: out/peers/points.csv if there."),
    ] = None,
    dry: DryOption = False,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Write scenes with every picture, misfit and cost as one HTML page that needs no other file.

    Without a scene: the figures of Guo & Li (2002), what they must show, and all studies.
    """
    for one in scenes or []:
        load(one, [], None, strict)
    from compare.cli import terminal, views
    from compare.report.report import build

    if dry:
        from compare.experiments.cost import dry_run

        dry_run.show_report(scenes or (), out, as_json)
        return
    with locked(out, out / "figures", out / "studies"), terminal.progress("report") as advance:
        found = build(out, advance, scenes=scenes or (), peers_table=peers)
    views.show_report(found, as_json)


def _cases(scene: str | None, changes: list[str], variant: str | None, strict: bool) -> list[Any]:
    """Return the variants whose effects are asked for; without a scene all that are shipped."""
    from compare.experiments.ablation.runner import Case, all_shipped

    if scene is not None:
        return [
            Case(scene, one)
            for one in load(scene, changes, variant if variant is not None else "", strict)
        ]
    if changes or variant is not None:
        key = "--set" if changes else "--variant"
        raise SceneError(key, "", None, "needs a scene: without one every shipped scene is taken")
    return all_shipped()
