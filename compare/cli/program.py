"""The entry of `jointwave`: whatever goes wrong is one line and an exit code, never a traceback."""

import atexit
import gc
import os
import sys
import traceback
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from jointwave.cases.errors import InterruptedRun, SceneError, UnstableError, printable
from jointwave.compare.runs.checkpoint.signals import Ended, watched
from jointwave.compare.runs.processes import Processes, started

SHOWN = "JOINTWAVE_TRACEBACK"  # in the environment: whether a fault of the program is traced back
ROOT = Path(__file__).parents[2]
MOST_LISTED = 100  # mistakes of a file
LONGEST = 1500  # characters of a message; an argument or a path in it may be of any length


def main() -> None:
    """Run the command line; every mistake is one line on standard error and a non-zero exit."""
    # With colorama there numba ends all that goes to a terminal, JSON too, by an escape sequence.
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    _open_streams()
    # Most of what a search would see has been imported, and stays: it took a third of a short run.
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    processes, sys.unraisablehook = Processes(), _unraisable
    try:
        signals = watched()
        processes = started()
        processes.mute_others()
        signals.patient = not processes.is_first  # the first decides for all
        code = run(sys.argv[1:] or ["--help"])
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough
        code = 1
    except (Exception, Ended, KeyboardInterrupt) as error:
        if (asked := watched().asked) and not isinstance(error, UnstableError):
            error = Ended(asked)  # which a library may have caught
        lines, code = _told(error)
        if code == 1 and os.environ.get(SHOWN):
            traceback.print_exc(file=processes.stderr)
        processes.fail("\n".join(f"jointwave: {line}" for line in map(_line, lines)), code)
    finally:
        _flush()
    sys.exit(code)


def _unraisable(found: Any) -> None:
    """Say nothing of a signal in a callback, which a compiler calls; it acts after that."""
    if not isinstance(found.exc_value, Ended):
        sys.__unraisablehook__(found)


def run(arguments: list[str]) -> int:
    """Import the commands and run one; returns its exit code."""
    from jointwave.compare.cli.commands import app

    code = app(arguments, standalone_mode=False)
    return code if isinstance(code, int) else 0


def _told(error: BaseException) -> tuple[list[str], int]:
    """Return what is said of an error, and the exit code; 1 for a fault of the program itself."""
    match error:
        case SceneError():
            lines, more = [str(one) for one in error.each], len(error.each) - MOST_LISTED
            return [*lines[:MOST_LISTED], *([f"and {more:,} more"] if more > 0 else [])], 2
        case InterruptedRun() | Ended():
            return [str(error)], error.code
        case UnstableError():
            return [str(error)], 3
        case KeyboardInterrupt():  # before the program has begun to watch for signals
            return ["interrupted"], 130
        case OSError():
            return [f"{error.filename or 'output'}: {error.strerror or error}"], 2
        case UnicodeEncodeError():  # of a file's name: all else is UTF-8, or escaped
            allowed = f"cannot be encoded in the locale's {error.encoding}; set PYTHONUTF8=1"
            return [f"{error.object!a}: {allowed}"], 2
        case MemoryError():
            return [f"not enough memory: {error}"], 2
    if usage := getattr(error, "format_message", None):  # of typer, whose class depends on versions
        return [usage().replace("Value error, ", "")], 2
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).is_relative_to(ROOT)] or frames
    at = f"{type(error).__name__} at {Path(own[-1].filename).name}:{own[-1].lineno}"
    return [f"internal error, {at}: {ascii(str(error))[1:-1]} (set {SHOWN}=1 for the traceback)"], 1


def _line(message: str) -> str:
    line = " ".join(printable(message).split())
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"
    return line


def _open_streams() -> None:
    """Let what is closed be as if sent to /dev/null, and what a locale cannot spell be escaped.

    A closed descriptor would be that of the next file opened, and be written to.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest that is free, which is this
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, mode, encoding="utf-8", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _flush() -> None:
    """Write what is left; where nobody takes it, let it go: the interpreter would complain."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
