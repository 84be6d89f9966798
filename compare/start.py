"""The way in to `jointwave`: what the program imports is interrupted in one line, too."""

import sys


def main() -> None:
    """Import the program and run it."""
    try:
        from compare.cli import main as run

        run()
    except KeyboardInterrupt:  # before the program has begun to watch for signals
        print("jointwave: interrupted", file=sys.stderr)
        sys.exit(130)
