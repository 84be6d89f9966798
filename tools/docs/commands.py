"""The commands and their options as a page, from the program itself."""

from typing import Any


def page() -> str:
    """Return every command with its help and its options."""
    return "\n\n".join(_section(name, command) for name, command in all_commands().items())


def all_commands() -> dict[str, Any]:
    """Return the commands of jointwave by name, in the order of its help."""
    import typer

    from jointwave.compare.cli.commands import app

    group = typer.main.get_command(app)
    return {name: group.commands[name] for name in group.list_commands(None)}


def options(command: Any) -> list[str]:
    """Return the options that a command takes, such as --out."""
    return [name for p in command.params for name in p.opts + p.secondary_opts if name[0] == "-"]


def _section(name: str, command: Any) -> str:
    rows = [_row(p) for p in command.params if any(o[0] == "-" for o in p.opts)]
    table = "\n".join(["| option | meaning |", "| --- | --- |", *rows]) if rows else ""
    arguments = "".join(f" {p.name.upper()}" for p in command.params if p.opts[0][0] != "-")
    return f"### `jointwave {name}{arguments}`\n\n{command.help.strip()}\n\n{table}"


def _row(option: Any) -> str:
    names = ", ".join(f"`{name}`" for name in option.opts + option.secondary_opts)
    return f"| {names} | {' '.join((option.help or '').split())} |"
