"""The memory that a run may use."""

import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from math import isfinite
from pathlib import Path

from jointwave.cases.errors import SceneError

LIMIT = "JOINTWAVE_MEMORY"  # environment variable: the user's limit, GB
LARGEST_VARIABLE = 2**31 - 4  # bytes, in a NetCDF 3 file
#: Memory limits of control groups, versions 2 and 1.
GROUPS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def memory() -> float:
    """Return the memory available to a run, bytes: JOINTWAVE_MEMORY, else that of the machine."""
    asked = os.environ.get(LIMIT)
    if asked is None:
        return _of_machine()
    try:
        limit = float(asked)
    except ValueError:
        limit = 0.0
    if not (limit > 0 and isfinite(limit)):
        raise SceneError(LIMIT, "", None, f"is {asked!r}, must be a positive number (GB)")
    return 1e9 * limit


@cache
def _of_machine() -> float:
    found = [float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")]
    for group in GROUPS:
        try:
            found.append(float(Path(group).read_text(encoding="ascii")))
        except (OSError, ValueError):  # there is none, or it is "max"
            continue
    return min(found)


def excess(size: float, part: str = "") -> str:
    """Return a message if a size (bytes) exceeds the available memory, else "".

    part : phrase about the part of it that the message concerns.
    """
    if size <= (limit := memory()):
        return ""
    need = f"would need about {spoken(size)} of memory{part}"
    return f"{need}; {spoken(limit)} available (set {LIMIT} to change it, in GB)"


def require(size: float, what: str) -> None:
    """Raise MemoryError if a size (bytes) exceeds the available memory."""
    if why := excess(size):
        raise MemoryError(f"{what} {why}")


@contextmanager
def within(room: float) -> Iterator[None]:
    """Make allocations beyond this many further bytes raise MemoryError, where supported."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    asked = pages * resource.getpagesize() + int(room)
    resource.setrlimit(resource.RLIMIT_AS, (min(x for x in (asked, soft, hard) if x >= 0), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def spoken(size: float) -> str:
    """Return a number of bytes as text."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"
