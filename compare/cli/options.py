"""The program `jointwave`, what its commands take, and how they read scenes."""

import inspect
import os
from collections.abc import Callable, Iterable, Sequence
from enum import StrEnum
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer

from jointwave.cases.errors import SceneError, all_of
from jointwave.cases.scene_type import AnyScene
from jointwave.compare import scenes
from jointwave.compare.cli.terminal import say_warnings
from jointwave.compare.engines import selection
from jointwave.compare.runs.processes import started
from jointwave.compare.scenes import shipped

#: The commands in the order in which a new user meets them.
ORDER = (
    *("new", "list", "explain", "picture", "run", "compare", "view", "animate", "figure"),
    *("report", "plan", "effects", "study", "fit", "doctor"),
)


class Commands(typer.core.TyperGroup):
    """The commands, in their order."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands."""
        return sorted(super().list_commands(ctx), key=ORDER.index)


app = typer.Typer(cls=Commands, pretty_exceptions_enable=False, rich_markup_mode=None)

SceneArgument = Annotated[
    str,
    typer.Argument(
        help="A scene file, or a shipped scene such as guo-li-2002/fig-03.",
        autocompletion=shipped,
    ),
]
#: What can simulate or solve a scene, as --engine selects it.
Engine = StrEnum("Engine", list(selection()))  # type: ignore[misc]
EngineOption = Annotated[
    list[Engine],
    typer.Option(help="dem: rigid blocks; continuum: rock; exact: exact solutions. Repeatable."),
]
ModelOption = Annotated[
    list[str] | None,
    typer.Option(help="Continuum model (jointed, equivalent) or name of an exact solution."),
]
SetOption = Annotated[
    list[str],
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key in every variant; repeatable."),
]
VariantOption = Annotated[
    str | None,
    typer.Option(help="Only this variant ('': the base scene)."),
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
    bool,
    typer.Option("--dry-run", help="Only print what would run, with its time and memory."),
]
StrictOption = Annotated[bool, typer.Option("--strict", help="Treat warnings as errors.")]
FreshOption = Annotated[
    bool, typer.Option("--fresh", help="Compute again what could be read from a folder.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print machine-readable JSON.")]

CORES = os.cpu_count() or 1
RESULTS = Path("out")  # default folder of the results of all scenes, each in a folder of its name


class SceneOptions(NamedTuple):
    """A scene, its variant and its changed keys."""

    scene: SceneArgument
    changes: SetOption = []
    variant: VariantOption = None
    strict: StrictOption = False

    def load(self, every: bool = True) -> list[AnyScene]:
        """Return the variant that is named, with `--set` applied, warned of; without one all or, if
        not `every`, the base scene."""
        from jointwave.cases.read import parse_override

        overrides = dict(parse_override(text) for text in self.changes)
        if self.variant is None and every:
            found = scenes.load_variants(self.scene, overrides)
        else:
            found = [scenes.load(self.scene, self.variant or "", overrides)]
        warn(found, self.strict)
        return found


class SweepOptions(NamedTuple):
    """Points of a sweep, members of an ensemble, and the processes that share them."""

    swept: Annotated[
        list[str],
        typer.Option(
            "--sweep",
            metavar="KEY=VALUES",
            help="Sweep a key over FROM:TO:COUNT, log:FROM:TO:COUNT or A,B,C; repeatable for all "
            "combinations. Writes a folder for each point, and sweep.csv.",
        ),
    ] = []
    members: Annotated[
        int,
        typer.Option(
            "--ensemble",
            metavar="N",
            min=0,
            max=10_000,
            help="Run N scenes with consecutive seeds of random joints: mean and percentiles of "
            "every number (ensemble.csv) and waveform (NAME-ensemble.nc).",
            show_default=False,
        ),
    ] = 0
    workers: WorkersOption = CORES


class StoredOptions(NamedTuple):
    """The folder that results are read from, and whether they are."""

    results: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Folder where results of the scene are read and stored (default: out/SCENE).",
        ),
    ] = None
    fresh: FreshOption = False

    def folder(self, scene: str, out: Path | None = None) -> Any:
        """Return the `ResultFolder` of a scene; out : where it is, if not said otherwise."""
        from jointwave.compare.runs.reuse import ResultFolder

        return ResultFolder(results_of(scene, self.results or out), self.fresh)


class PrintOptions(NamedTuple):
    """What is printed: estimates in place of results, or JSON."""

    dry: DryOption = False
    as_json: JsonOption = False


def command(work: Callable[..., None]) -> Callable[..., None]:
    """Return a command of the program, in which each group of options above is its options."""
    groups, flat = {}, list[inspect.Parameter]()
    for own in inspect.signature(work).parameters.values():
        if hasattr(own.annotation, "_fields"):
            groups[own.name] = own.annotation
            flat += inspect.signature(own.annotation).parameters.values()
        else:
            flat.append(own)

    def run(**given: Any) -> None:
        made = {name: of(*map(given.pop, of._fields)) for name, of in groups.items()}
        work(**made, **given)

    run.__name__, run.__doc__ = work.__name__, work.__doc__
    by_name = [one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in flat]
    run.__signature__ = inspect.Signature(by_name)  # type: ignore[attr-defined]
    run.__annotations__ = {one.name: one.annotation for one in flat}
    return app.command()(run)


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


def results_of(scene: str, given: Path | None = None) -> Path:
    """Return the folder of a scene's results: as given, else the default one."""
    return given or RESULTS / Path(scene).stem


def warn(
    scenes: Sequence[AnyScene],
    strict: bool = False,
    of: Callable[[AnyScene], Iterable[str]] | None = None,
) -> None:
    """Print what scenes say but hardly mean, each line once; strict : it is an error.

    of : returns the lines of a scene; None: what the scene itself says. Raises SceneError of all
    lines.
    """
    from jointwave.cases.warnings import warnings
    from jointwave.compare.solvers.incident import side_warnings

    of = of or (lambda scene: [*warnings(scene), *side_warnings(scene)])
    lines = list(dict.fromkeys(line for scene in scenes for line in of(scene)))
    if strict and lines:
        where, why = scenes[0].where, "(an error by --strict)"
        raise all_of(SceneError(where, "", None, f"{line} {why}") for line in lines)
    say_warnings(lines)
