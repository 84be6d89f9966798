"""Commands about one scene: what it is, its runs, and how far apart its solutions are.

Heavy packages are imported by the command that needs them, so a run of the rigid blocks starts
without dolfinx and matplotlib.
"""

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

import cases
from cases.errors import SceneError
from compare.options import (
    JsonOption,
    OutOption,
    SceneArgument,
    SetOption,
    VariantOption,
    app,
    load,
    warn,
)
from compare.processes import started
from compare.scenes import shipped


class Engine(StrEnum):
    """What can simulate or solve a scene."""

    dem = "dem"
    continuum = "continuum"
    exact = "exact"


@app.command("list")
def list_scenes(as_json: JsonOption = False) -> None:
    """List the shipped scenes and their variants."""
    from compare import views

    rows = [(path, cases.load(path)) for path in shipped()]
    views.show_scenes(rows, as_json)


@app.command()
def run(
    scene: SceneArgument,
    engine: Annotated[list[Engine], typer.Option(help="May be given more than once.")] = [  # noqa: B006
        Engine.dem
    ],
    model: Annotated[
        list[str] | None,
        typer.Option(help="Of the continuum (jointed, equivalent) or an exact solution's name."),
    ] = None,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    out: OutOption = Path("results"),
    vtx: Annotated[
        bool, typer.Option("--vtx", help="Also write the snapshots of record.fields as VTX (.bp).")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Simulate a scene and write each result as DIR/[variant/]ENGINE[-MODEL].nc.

    With record.fields also its snapshots, as a .pvd file for ParaView. Under mpiexec the processes
    share each run of the continuum; everything else is done by the first of them.
    """
    from compare import runs, terminal, views

    scenes = load(scene, changes, variant)
    wanted = runs.wanted([e.value for e in engine], model or [])
    jobs = runs.plan(scenes, wanted, out)
    warn(scenes)
    processes = started()
    with terminal.progress(f"{len(jobs)} runs") as advance:
        done = runs.execute(jobs, advance, vtx, processes)
    processes.by_first(lambda: views.show_runs(done, as_json))


@app.command()
def explain(
    scene: SceneArgument,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what a scene calls for, its critical steps, and which exact solutions hold."""
    from compare import views
    from compare.effort import is_measured
    from compare.explain import explanation

    scenes = load(scene, changes, variant if variant is not None else "")
    warn(scenes)
    if sys.stderr.isatty() and not is_measured():
        print("jointwave: measuring once what every effect costs, about a minute", file=sys.stderr)
    for one in scenes:
        views.show_explanation(explanation(one), as_json)


@app.command()
def compare(
    scene: SceneArgument,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    out: Annotated[Path | None, typer.Option(help="Also write tables, curves and figure.")] = None,
    spectral: Annotated[
        bool, typer.Option(help="Add envelope and phase misfit (Kristekova et al. 2006).")
    ] = True,
    given: Annotated[
        list[str],
        typer.Option("--with", metavar="FILE[:LABEL]", help="Curves of others; more than once."),
    ] = [],  # noqa: B006
    align: Annotated[
        bool, typer.Option("--align", help="Move the clock of each --with by cross-correlation.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Solve a scene by all that applies, and print how far apart the solutions are.

    --with puts a waveform of another code, figure or experiment beside them: a CSV file with a
    header such as "time [ms], stress@20 [MPa]" (# starts a comment; commas, semicolons or tabs),
    or a NetCDF file of jointwave run or with time and stress(time). A label names the only curve
    of a file without names, or takes one out of several: curve.csv:stress@20,
    "run.nc:-velocity@20.25 [mm/s]". Without a unit, SI. Stress is positive in compression; a minus
    sign says that the file has the negative. Only the overlap in time is compared, at the times of
    whichever has fewer samples there, the other interpolated linearly; amplitudes are never scaled,
    and clocks never moved without --align.
    """
    from compare import pairs, terminal, views

    scenes = load(scene, changes, variant)
    curves = _read_curves(given, scenes, align)
    found = []
    for one in scenes:
        with terminal.progress(one.name or one.title) as advance:
            found.append(pairs.compare(one, advance, spectral, curves, align))
    if out is not None:
        from compare.report import write_comparisons

        write_comparisons(found, out)
    views.show_comparisons(found, as_json)


def _read_curves(given: list[str], scenes: list[cases.Scene], align: bool) -> list[Any]:
    """Read what `--with` names; what is wrong with it is said before anything is solved."""
    if not given:
        if align:
            raise SceneError("--align", "", None, "needs --with: there is no clock to move")
        return []
    from compare.aligned import common_times
    from compare.curves import read_curves

    curves = read_curves(given, scenes)
    if not align:
        for scene in scenes:
            for one in curves:
                common_times(one, scene)
    return curves
