"""The way in to `jointwave`: what the program imports is interrupted in one line, too."""

import os
import sys


def main() -> None:
    """Import the program and run it."""
    # With colorama there numba ends all that goes to a terminal, JSON too, by an escape sequence.
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")
    try:
        from compare.cli import main as run

        run()
    except KeyboardInterrupt:  # before the program has begun to watch for signals
        print("jointwave: interrupted", file=sys.stderr)
        sys.exit(130)
