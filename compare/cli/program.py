"""The entry of `jointwave`: what goes wrong is one line and an exit code, never a traceback."""

import os
import sys
import traceback
from typing import Any

import typer

from jointwave.cases.errors import InterruptedRun, SceneError, UnstableError, printable
from jointwave.compare.cli.commands import (
    animation,
    experiments,
    fit,
    installation,
    scenes,
    solutions,
)
from jointwave.compare.cli.options import app
from jointwave.compare.cli.start import SHOWN, drop_output, fault
from jointwave.compare.runs.checkpoint.signals import Ended, exit_code, watched
from jointwave.compare.runs.processes import Processes, started

#: Their import puts the commands into the app.
COMMANDS = (scenes, solutions, fit, experiments, animation, installation)

# Older typer raises click's own errors and newer typer its copy of them: ask the class itself.
UsageError: Any = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")

MOST_LISTED = 100  # mistakes of a file
LONGEST = 1500  # characters of a message; an argument or a path in it may be of any length


def main() -> None:
    """Run the command line; every mistake is one line on standard error and a non-zero exit."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    processes = Processes()
    try:
        signals = watched()
        processes = started()
        processes.mute_others()
        signals.patient = not processes.is_first  # the first decides for all
        code = app(standalone_mode=False)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough
        drop_output(sys.stdout)
        sys.exit(1)
    except (Exception, Ended) as error:
        lines, code = _told(error)
        if code == 1 and processes.comm is None:
            raise
        if code == 1 and os.environ.get(SHOWN):
            traceback.print_exc(file=processes.stderr)
        processes.fail("\n".join(f"jointwave: {line}" for line in map(_line, lines)), code)
    sys.exit(code if isinstance(code, int) else 0)


def _told(error: Any) -> tuple[list[str], int]:
    """Return what is said of an error, and the exit code; 1 for a fault of the program itself."""
    match error:
        case SceneError():
            lines, more = [str(one) for one in error.each], len(error.each) - MOST_LISTED
            return [*lines[:MOST_LISTED], *([f"and {more:,} more"] if more > 0 else [])], 2
        case InterruptedRun():
            return [str(error)], error.code
        case UnstableError():
            return [str(error)], 3
        case Ended():
            return [str(error)], exit_code(error.number)
        case OSError():
            if error.filename is None:
                drop_output(sys.stdout)
            return [f"{error.filename or 'output'}: {error.strerror or error}"], 2
        case UnicodeEncodeError():  # of a file's name: all else is UTF-8, or escaped
            allowed = f"cannot be encoded in the locale's {error.encoding}; set PYTHONUTF8=1"
            return [f"{error.object!a}: {allowed}"], 2
        case MemoryError():
            return [f"not enough memory: {error}"], 2
    if isinstance(error, UsageError):
        return [error.format_message().replace("Value error, ", "")], 2
    return [fault(error)], 1


def _line(message: str) -> str:
    line = " ".join(printable(message).split())
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    return line
