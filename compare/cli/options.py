"""The program `jointwave`, and the options that several commands share.

A command is a class: its fields are the options, its docstring is the help, and the function that
executes it is imported when it is called. Help and completion thus import no heavy modules.
"""

import os
from collections.abc import Callable
from enum import StrEnum
from functools import partial
from importlib.metadata import version
from inspect import Parameter, Signature
from pathlib import Path
from pkgutil import resolve_name
from types import SimpleNamespace
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import selection
from jointwave.compare.runs.processes import started
from jointwave.compare.scenes import shipped

C = TypeVar("C", bound=type)

app = typer.Typer(pretty_exceptions_enable=False, rich_markup_mode=None)

#: The values of --engine.
Engine = StrEnum("Engine", list(selection()))  # type: ignore[misc]
EngineOption = Annotated[
    list[Engine],
    typer.Option(help="dem: rigid blocks; continuum: rock; exact: exact solutions. Repeatable."),
]
ModelOption = Annotated[
    list[str] | None,
    typer.Option(help="Continuum model (jointed, equivalent) or name of an exact solution."),
]
WithOption = Annotated[
    list[str],
    typer.Option(
        "--with",
        metavar="FILE[:COLUMN][=][LABEL]",
        help="Measured or other curves: FILE, FILE:stress@20, FILE:COLUMN=stress@20; repeatable.",
    ),
]
WorkersOption = Annotated[
    int, typer.Option(min=1, help="Number of processes; what is timed runs in one.")
]
DryOption = Annotated[
    bool, typer.Option("--dry-run", help="Only print what would run, with its time and memory.")
]
StrictOption = Annotated[bool, typer.Option("--strict", help="Treat warnings as errors.")]
FreshOption = Annotated[
    bool, typer.Option("--fresh", help="Compute again what could be read from a folder.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print machine-readable JSON.")]
CORES = os.cpu_count() or 1


class SceneOptions(SimpleNamespace):
    """A scene, its variant and its changed keys."""

    scene: str = typer.Argument(
        ...,
        help="A scene file, or a shipped scene such as guo-li-2002/fig-03.",
        autocompletion=shipped,
    )
    changes: list[str] = typer.Option(
        [], "--set", metavar="KEY=VALUE", help="Change a key in every variant; repeatable."
    )
    variant: str | None = typer.Option(None, help="Only this variant ('': the base scene).")
    strict: StrictOption = False


class SweepOptions(SceneOptions):
    """Options of sweeps and ensembles, and the number of processes."""

    swept: list[str] = typer.Option(
        [],
        "--sweep",
        metavar="KEY=VALUES",
        help="Sweep a key over FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C; repeatable for all "
        "combinations. Writes a folder for each point, and sweep.csv.",
    )
    members: int = typer.Option(
        0,
        "--ensemble",
        metavar="N",
        min=0,
        max=10_000,
        help="Run N scenes with consecutive seeds of random joints: mean and percentiles of "
        "every number (ensemble.csv) and waveform (NAME-ensemble.nc).",
        show_default=False,
    )
    workers: WorkersOption = CORES


class StoredOptions(SceneOptions):
    """The folder of stored results, and whether to read them."""

    results: Path | None = typer.Option(
        None,
        metavar="DIR",
        help="Folder where results of the scene are read and stored (default: out/SCENE).",
    )
    fresh: FreshOption = False


class PrintOptions(SimpleNamespace):
    """Options of printing: estimates instead of results, or JSON."""

    dry: DryOption = False
    as_json: JsonOption = False


def command(work: str) -> Callable[[C], C]:
    """Return a decorator that adds a class of options as the command of its name.

    work : the function that takes the options, "module:name" in this package. Options of base
    classes come first, starting with the last base.
    """

    def add(of: C) -> C:
        def run(**given: Any) -> None:
            resolve_name(f"{__package__}.{work}")(of(**given))

        run.__doc__, run.__annotations__ = of.__doc__, get_type_hints(of, include_extras=True)
        named = partial(Parameter, kind=Parameter.KEYWORD_ONLY)
        fields = [
            named(name, default=getattr(of, name, Parameter.empty), annotation=hint)
            for name, hint in run.__annotations__.items()
        ]
        run.__signature__ = Signature(fields)  # type: ignore[attr-defined]
        app.command(of.__name__.lower())(run)
        return of

    return add


def _print_version(wanted: bool) -> None:
    if wanted:
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
    """Stress waves in jointed rock: rigid blocks and continuum, refereed by exact solutions.

    \b
    First steps:
      jointwave new my-scene           write a scene with every key explained
      jointwave explain my-scene.toml  its effects, time steps and solutions
      jointwave compare my-scene.toml  solve it by all means; how far apart, why
      jointwave animate my-scene.toml  the wave as a film
      jointwave list                   the shipped scenes, used by their names
    """
    command = context.invoked_subcommand
    if command not in ("run", "study") and started().comm is not None:
        allowed = f"jointwave {command} runs in one process; only run and study support mpiexec"
        raise SceneError("mpiexec", "", None, allowed)
