"""The entry point of `jointwave`: an error becomes one line and an exit code, not a traceback."""

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

SHOWN = "JOINTWAVE_TRACEBACK"  # environment variable: print the traceback of an internal error
ROOT = Path(__file__).parents[2]
MOST_LISTED = 100  # mistakes of a file
LONGEST = 1500  # characters of a message, which may contain an argument or path of any length


def main() -> None:
    """Run the command line; an error is one line on standard error and a non-zero exit code."""
    # If colorama is installed, numba appends an escape sequence to all terminal output, JSON too.
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    os.environ["MPLBACKEND"] = "agg"  # figures are written to files, whatever a shell has set
    _open_streams()
    # Most objects are imported modules, which stay: collecting garbage took a third of a short run.
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
    processes, sys.unraisablehook = Processes(), _unraisable
    try:
        signals = watched()
        processes = started()
        processes.mute_others()
        signals.patient = not processes.is_first  # the first process decides for all
        code = run(sys.argv[1:] or ["--help"])
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has closed the pipe
        code = 1
    except (Exception, Ended, KeyboardInterrupt) as error:
        if (number := watched().asked) and not isinstance(error, UnstableError):
            error = Ended(number)  # a library may have caught it
        lines, code = _message_and_code(error)
        if code == 1 and os.environ.get(SHOWN):
            traceback.print_exc(file=processes.stderr)
        processes.fail("\n".join(f"jointwave: {line}" for line in map(_line, lines)), code)
    finally:
        _flush()
    sys.exit(code)


def _unraisable(found: Any) -> None:
    """Ignore a signal during a compiler's callback; it takes effect afterwards."""
    if not isinstance(found.exc_value, Ended):
        sys.__unraisablehook__(found)


def run(arguments: list[str]) -> int:
    """Import the commands, run one and return its exit code."""
    from jointwave.compare.cli.commands import app

    if (first := arguments[0]).endswith(".toml") or ("/" in first and first[0] != "-"):
        allowed = f"a command comes first, such as jointwave compare {first}; jointwave lists them"
        raise SceneError(first, "", None, allowed)
    code = app(arguments, standalone_mode=False)
    return code if isinstance(code, int) else 0


def _message_and_code(error: BaseException) -> tuple[list[str], int]:
    """Return the lines to print for an error, and the exit code; 1 for an internal error."""
    match error:
        case SceneError():
            lines, more = [str(one) for one in error.each], len(error.each) - MOST_LISTED
            return [*lines[:MOST_LISTED], *([f"and {more:,} more"] if more > 0 else [])], 2
        case InterruptedRun() | Ended():
            return [str(error)], error.code
        case UnstableError():
            return [str(error)], 3
        case KeyboardInterrupt():  # before signal handlers are installed
            return ["interrupted"], 130
        case FileExistsError():
            return [f"{error.filename}: is a file, must be a folder"], 2
        case OSError():
            return [f"{error.filename or 'output'}: {error.strerror or error}"], 2
        case UnicodeEncodeError():  # in a file name; all other text is UTF-8 or escaped
            allowed = f"cannot be encoded in the locale's {error.encoding}; set PYTHONUTF8=1"
            return [f"{error.object!a}: {allowed}"], 2
        case MemoryError():
            return [f"not enough memory: {error}"], 2
    if usage := getattr(error, "format_message", None):  # from typer; its class depends on versions
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
    """Redirect closed standard streams to /dev/null, and escape what the locale cannot encode.

    Otherwise the next file opened would get the closed descriptor, and be written to.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free descriptor, this one
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, mode, encoding="utf-8", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _flush() -> None:
    """Flush the streams; discard what cannot be written, as the interpreter would complain."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
