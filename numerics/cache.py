"""The cache of compiled kernels: one folder for each version of the sources."""

import atexit
import fcntl
import hashlib
import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile, mkdtemp
from threading import Timer
from time import time

import numba

PACKAGES = ("numerics", "joints", "dem", "continuum")
STATE = re.compile("[0-9a-f]{16}")  # name of a version's folder
UNUSED = 30 * 86400.0  # s, after which a version is removed


def cache_directory(root: Path) -> Path:
    """Return a cache directory keyed by the sources of the kernels' packages below `root`.

    numba would not recompile a caller if a function in another file changes.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    for package in PACKAGES:
        for source in sorted((root / package).rglob("*.py")):
            digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or Path(cache_home(), "jointwave", "numba")
    return Path(base, digest.hexdigest()[:16])


def cache_home() -> str:
    """Return the user's folder of caches, where dolfinx has its own, too; one for this process and
    those it starts, if it cannot be written."""
    usual = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    try:
        os.makedirs(usual, exist_ok=True)
        TemporaryFile(dir=usual).close()
    except OSError:
        usual = mkdtemp(prefix="jointwave-")
        atexit.register(shutil.rmtree, usual, ignore_errors=True)
    os.environ["XDG_CACHE_HOME"] = usual  # read by dolfinx when it is imported
    return usual


def mark_used(directory: Path) -> None:
    """Record the use of a version, if it is cached and writable."""
    with suppress(OSError):
        os.utime(directory)


def make(directory: Path) -> None:
    """Create the folder of a version if missing, and remove those of versions that were not used
    for `UNUSED`, and no other files."""
    if not directory.exists():
        directory.mkdir(parents=True, exist_ok=True)
        for state in directory.parent.iterdir():
            with suppress(OSError):
                if STATE.fullmatch(state.name) and time() - state.stat().st_mtime > UNUSED:
                    shutil.rmtree(state)


@contextmanager
def one_process(lock: Path, wait: float, announce: Callable[[], None]) -> Iterator[None]:
    """Hold the lock of a cache, for which other processes wait; call `announce` after `wait`, s."""
    timer = Timer(wait, announce)
    with ExitStack() as held:
        with suppress(OSError):  # the cache is not writable
            lock.parent.mkdir(parents=True, exist_ok=True)
            fcntl.flock(held.enter_context(lock.open("w")), fcntl.LOCK_EX)
        held.callback(timer.cancel)
        timer.daemon = True
        timer.start()
        yield
