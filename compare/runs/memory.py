"""Rare garbage collection in a process of short life."""

import atexit
import gc


def collect_rarely() -> None:
    """Let this process search rarely, and not at its exit: most of what it would search is what has
    been imported, which stays."""
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)
