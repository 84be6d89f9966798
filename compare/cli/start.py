"""The way in to `jointwave`: whatever goes wrong, its import included, is one line."""

import os
import sys
import traceback
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import TextIO

SHOWN = "JOINTWAVE_TRACEBACK"  # in the environment: whether a fault of the program is traced back


def main() -> None:
    """Import the program and run it."""
    # With colorama there numba ends all that goes to a terminal, JSON too, by an escape sequence.
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    _open_streams()
    try:
        from jointwave.compare.runs.memory import collect_rarely

        collect_rarely()  # a third of a short run
        from jointwave.compare.cli.program import main as run

        run()
    except KeyboardInterrupt:  # before the program has begun to watch for signals
        _end("interrupted", 130)
    except Exception as error:
        if os.environ.get(SHOWN):
            raise
        _end(fault(error), 1)
    finally:
        _flush()


def fault(error: Exception) -> str:
    """Return in one line what went wrong in the program itself, and where."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).is_relative_to(ROOT)] or frames
    at = f" at {Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""
    said = ascii(str(error))[1:-1]
    return f"internal error, {type(error).__name__}{at}: {said} (set {SHOWN}=1 for the traceback)"


ROOT = Path(__file__).parents[2]


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


def _end(message: str, code: int) -> None:
    with suppress(OSError):
        print(f"jointwave: {message}", file=sys.stderr, flush=True)
    sys.exit(code)


def _flush() -> None:
    """Write what is left; where nobody takes it, let it go: the interpreter would complain."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                drop_output(stream)


def drop_output(stream: TextIO) -> None:
    """Let what cannot be written to a stream go: flushing at exit must not complain."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
