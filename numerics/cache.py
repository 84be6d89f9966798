"""The cache of compiled kernels: a folder for each state of the sources, while it is in use."""

import hashlib
import os
import re
import shutil
from contextlib import suppress
from pathlib import Path
from time import time

import numba

PACKAGES = ("numerics", "joints", "dem", "continuum")
STATE = re.compile("[0-9a-f]{16}")  # how the folder of a state is called
UNUSED = 30 * 86400.0  # s, after which a state is taken for one of the past


def cache_directory(root: Path) -> Path:
    """Return a cache directory keyed by the sources of the kernels' packages below `root`.

    A compiled caller does not notice that a function in another file has changed; a new
    directory for each state of the sources does.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    for package in PACKAGES:
        for source in sorted((root / package).rglob("*.py")):
            digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or Path(
        os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "jointwave", "numba"
    )
    return Path(base, digest.hexdigest()[:16])


def mark_used(directory: Path) -> None:
    """Note that a state is used now, where it is kept and can be written."""
    with suppress(OSError):
        os.utime(directory)


def make(directory: Path) -> None:
    """Make the folder of a state where it is not there yet, and drop those that went unused."""
    if not directory.exists():
        directory.mkdir(parents=True, exist_ok=True)
        forget_unused(directory.parent)


def forget_unused(base: Path) -> None:
    """Remove the states, and nothing else, that no program has used for `UNUSED`."""
    for state in base.iterdir():
        with suppress(OSError):
            if STATE.fullmatch(state.name) and time() - state.stat().st_mtime > UNUSED:
                shutil.rmtree(state)
