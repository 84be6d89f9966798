"""The entry of `jointwave`: what goes wrong is one line and an exit code, never a traceback."""

import os
import sys
import traceback
from typing import Any

import typer

from cases.errors import InterruptedRun, SceneError, UnstableError, printable
from compare.cli.commands import animation, experiments, installation, scenes, solutions
from compare.cli.commands import fit as fitting
from compare.cli.options import app
from compare.cli.start import SHOWN, fault
from compare.runs.checkpoint.signals import Ended, exit_code, watched
from compare.runs.processes import Processes, started

COMMANDS = (
    scenes,
    solutions,
    fitting,
    experiments,
    animation,
    installation,
)  # their import puts them into the app

# Older typer raises click's own errors and newer typer its copy of them: ask the class itself.
UsageError: type[Exception] = next(
    c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException"
)

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
    except SceneError as error:
        processes.fail("\n".join(_listed([_line(str(one)) for one in error.each])), 2)
    except InterruptedRun as error:
        _fail(processes, str(error), error.code)
    except UnstableError as error:
        _fail(processes, str(error), 3)
    except UsageError as error:
        _fail(processes, _usage(error), 2)
    except Ended as end:
        _fail(processes, str(end), exit_code(end.number))
    except BrokenPipeError:  # the reader has seen enough
        _drop_output()
        sys.exit(1)
    except OSError as error:
        if error.filename is None:
            _drop_output()
        _fail(processes, f"{error.filename or 'output'}: {error.strerror or error}", 2)
    except UnicodeEncodeError as error:  # of a file's name: all else is UTF-8, or escaped
        allowed = f"cannot be encoded in the locale's {error.encoding}; set PYTHONUTF8=1"
        _fail(processes, f"{error.object!a}: {allowed}", 2)
    except MemoryError as error:
        _fail(processes, f"not enough memory: {error}", 2)
    except Exception as error:
        if processes.comm is None:
            raise
        if os.environ.get(SHOWN):
            traceback.print_exc(file=processes.stderr)
        _fail(processes, fault(error), 1)
    else:
        sys.exit(code if isinstance(code, int) else 0)


def _drop_output() -> None:
    """Let what cannot be written to standard output go: flushing at exit must not complain."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _usage(error: Any) -> str:
    return error.format_message().replace("Value error, ", "")


def _fail(processes: Processes, message: str, code: int) -> None:
    processes.fail(f"jointwave: {_line(message)}", code)


def _listed(lines: list[str]) -> list[str]:
    more = len(lines) - MOST_LISTED
    lines = [*lines[:MOST_LISTED], f"and {more:,} more"] if more > 0 else lines
    return [f"jointwave: {line}" for line in lines]


def _line(message: str) -> str:
    line = " ".join(printable(message).split())
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    return line
