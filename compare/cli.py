"""The command `jointwave`: reads scenes, runs what is asked, prints tables and writes files.

Heavy packages are imported by the command that needs them, so a run of the rigid blocks starts
without dolfinx and matplotlib.
"""

import gc
import os
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

import cases
from cases.errors import SceneError, UnstableError
from compare.processes import Processes, started
from compare.scenes import find, shipped

# Older typer raises click's own errors and newer typer its copy of them: ask the class itself.
UsageError: type[Exception] = next(
    c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException"
)

LONGEST = 1500  # characters of a message; an argument or a path in it may be of any length

app = typer.Typer(
    epilog="Start with: jointwave list, jointwave compare guo-li-2002/fig-03, jointwave report",
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

SceneArgument = Annotated[
    str, typer.Argument(help="A scene file, or a shipped scene such as guo-li-2002/fig-03.")
]
SetOption = Annotated[
    list[str],
    typer.Option("--set", metavar="KEY=VALUE", help="Change one key, for every variant."),
]
VariantOption = Annotated[
    str | None, typer.Option(help="Only this variant; '' is the scene as it stands.")
]
OutOption = Annotated[Path, typer.Option(help="Folder for the results.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON for a machine to read.")]


class Engine(StrEnum):
    """What can simulate or solve a scene."""

    dem = "dem"
    continuum = "continuum"
    exact = "exact"


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"jointwave {version('jointwave')}")
        raise typer.Exit


@app.callback()
def root(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Stress waves in jointed rock: rigid blocks and continuum, refereed by exact solutions."""
    command = context.invoked_subcommand
    if command not in ("run", "study") and started().comm is not None:
        allowed = f"jointwave {command} works in one process; only run and study share their work"
        raise SceneError("mpiexec", "", None, allowed)


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

    scenes = _load(scene, changes, variant)
    wanted = runs.wanted([e.value for e in engine], model or [])
    jobs = runs.plan(scenes, wanted, out)
    _warn(scenes)
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

    scenes = _load(scene, changes, variant if variant is not None else "")
    _warn(scenes)
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

    scenes = _load(scene, changes, variant)
    curves = _read_curves(given, scenes, align)
    found = []
    for one in scenes:
        with terminal.progress(one.name or one.title) as advance:
            found.append(pairs.compare(one, advance, spectral, curves, align))
    if out is not None:
        from compare.report import write_comparisons

        write_comparisons(found, out)
    views.show_comparisons(found, as_json)


@app.command()
def effects(
    scene: SceneArgument,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what every effect of a scene costs, and how far the answer is without it."""
    from compare import terminal, worth, worth_view

    found = []
    for one in _load(scene, changes, variant if variant is not None else ""):
        with terminal.progress(one.name or one.title) as advance:
            found.append(worth.balance(one, advance))
    worth_view.show_balances(found, as_json)


@app.command()
def plan(
    scene: SceneArgument,
    misfit: Annotated[float, typer.Option(min=0.0, help="Relative L2, from the finest physics.")],
    seconds: Annotated[
        float | None, typer.Option(min=0.0, help="At most so long a run, the best within it.")
    ] = None,
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the cheapest engine, elements and step that meet a misfit, by a few cheap runs."""
    from compare import plan_view, planner, terminal

    found = []
    for one in _load(scene, changes, variant if variant is not None else ""):
        with terminal.progress(one.name or one.title) as advance:
            found.append(planner.plan(one, misfit, seconds, advance))
    plan_view.show_plans(found, misfit, as_json)


@app.command()
def study(
    name: Annotated[str, typer.Argument(help="A shipped study or a study's TOML file.")],
    out: Annotated[Path, typer.Option(help="Folder for tables and points.")] = Path("studies"),
    workers: Annotated[
        int, typer.Option(min=1, help="Processes, where points are not timed.")
    ] = os.cpu_count() or 1,
    as_json: JsonOption = False,
) -> None:
    """Run a study: a scene solved in many ways, each with its error and its cost, as one table.

    Points that are done are kept in DIR/NAME/ and not run again. Under mpiexec the processes share
    the points; those of a timed study are run one at a time.
    """
    from compare import terminal
    from compare.studies.pool import on_pool
    from compare.studies.runner import run as run_points
    from compare.studies.show import show_study
    from compare.studies.study import load
    from compare.studies.table import write_table

    asked, stem = load(name), Path(name).stem
    with terminal.progress(asked.title) as advance:
        rows = on_pool(
            started(), workers, lambda pool: run_points(asked, out / stem, pool, advance)
        )
    if rows is not None:
        show_study(asked, rows, write_table(out, stem, asked, rows), as_json)


@app.command()
def report(out: OutOption = Path("report"), as_json: JsonOption = False) -> None:
    """Write the figures of Guo & Li (2002) with every misfit and finding, as one HTML page."""
    from compare import terminal, views
    from compare.report import build

    with terminal.progress("scenes") as advance:
        found = build(out, advance)
    views.show_report(found, as_json)


def _load(scene: str, changes: list[str], variant: str | None) -> list[cases.Scene]:
    from cases.read import parse_override

    overrides = dict(parse_override(text) for text in changes)
    path = find(scene)
    if variant is None:
        return cases.load(path, overrides)
    return [cases.load_variant(path, variant, overrides)]


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


def _warn(scenes: list[cases.Scene]) -> None:
    from cases.effects import warnings

    for warning in dict.fromkeys(w for scene in scenes for w in warnings(scene)):
        print(f"jointwave: {warning}", file=sys.stderr)


def main() -> None:
    """Run the command line; every mistake is one line on standard error and a non-zero exit."""
    # What is imported stays: looking through it for garbage costs a tenth of a short run.
    gc.set_threshold(100_000)
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    processes = Processes()
    try:
        processes = started()
        processes.mute_others()
        code = app(standalone_mode=False)
    except SceneError as error:
        _fail(processes, str(error), 2)
    except UnstableError as error:
        _fail(processes, str(error), 3)
    except UsageError as error:
        _fail(processes, _usage(error), 2)
    except (typer.Abort, KeyboardInterrupt):
        _fail(processes, "interrupted", 130)
    except BrokenPipeError:  # the reader has seen enough; flushing at exit must not complain
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        _fail(processes, f"{error.filename or 'output'}: {error.strerror or error}", 2)
    except MemoryError as error:
        _fail(processes, f"not enough memory: {error}", 2)
    except Exception:
        if processes.comm is None:
            raise
        processes.crash()
    else:
        sys.exit(code if isinstance(code, int) else 0)


def _usage(error: Any) -> str:
    return error.format_message().replace("Value error, ", "")


def _fail(processes: Processes, message: str, code: int) -> None:
    line = " ".join(message.split())
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    processes.fail(f"jointwave: {line}", code)
