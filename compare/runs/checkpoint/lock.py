"""One run at a time in a folder of results."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile

from cases.errors import SceneError


@contextmanager
def locked(folder: Path, *inner: Path) -> Iterator[None]:
    """Lock a folder for one command that writes results there and in `inner`, and sweep them.

    A folder that is made for this, and left empty, is removed at the end.

    Raises SceneError where another command has locked it, OSError where nothing can be written.
    """
    from compare.runs.output import sweep

    made = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        with exclusive(folder):
            TemporaryFile(dir=folder).close()  # it can be written, which a lock does not tell
            for each in {folder, *inner}:
                sweep(each)
            yield
    finally:
        with suppress(OSError):
            for empty in made:
                empty.rmdir()


@contextmanager
def exclusive(folder: Path, wait: bool = False) -> Iterator[None]:
    """Lock a folder, made where there is none; wait : until nobody else has locked it.

    The lock is one on the folder itself: no file is written that a link could lead elsewhere, and
    the system releases it when a process is killed. Libraries for locks all write a file.
    Raises SceneError where another process has locked it and this one is not to wait.
    """
    handle = _locked(folder, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
    try:
        yield
    finally:
        os.close(handle)


def _locked(folder: Path, operation: int) -> int:
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            fcntl.flock(handle, operation)
            # Whoever had locked it may have removed it in between.
            if os.path.samestat(os.fstat(handle), folder.stat()):
                return handle
        except FileNotFoundError:
            pass
        except BlockingIOError:
            os.close(handle)
            allowed = "another jointwave process is writing here; wait for it"
            raise SceneError(str(folder), "", None, allowed) from None
        os.close(handle)
