"""Commands around the work: begin a scene, look the installation over."""

from typing import Annotated

import typer

from jointwave.cases.errors import SceneError
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import JsonOption, command
from jointwave.compare.scenes import shipped


@command
def new(
    name: Annotated[str, typer.Argument(help="File name, with or without .toml.")],
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="SCENE",
            help="Copy this scene with its comments and files.",
            autocompletion=shipped,
        ),
    ] = None,
    rock_mass: Annotated[
        bool, typer.Option("--rock-mass", help="Write a rock mass with one joint, not a pillar.")
    ] = False,
) -> None:
    """Write a scene to start from, NAME.toml, with every key explained.

    It runs as it is. Existing files are not overwritten.
    """
    from jointwave.compare.cli.new import write_new

    if rock_mass and source is not None:
        raise SceneError("--rock-mass", "", None, "has no meaning with --from")
    for path in write_new(name, source, "rock-mass" if rock_mass else "pillar"):
        terminal.say(f"wrote {path}")


@command
def doctor(as_json: JsonOption = False) -> None:
    """Print what is installed, and check both engines.

    The engines are checked against exact solutions, and missing or broken parts are listed. The
    exit code is 0 if both engines pass, else 1. The first run compiles kernels, which takes up to a
    minute.
    """
    from jointwave.compare.cli.doctor import examine

    with terminal.progress("looking"):
        found = examine()
    (terminal.print_json if as_json else terminal.show_facts)(found)
    raise typer.Exit(0 if found["well"] else 1)
