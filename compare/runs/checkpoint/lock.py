"""One run at a time in a folder of results."""

import fcntl
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile

from jointwave.cases.errors import SceneError

log = logging.getLogger("jointwave")


@contextmanager
def locked(folder: Path, *inner: Path) -> Iterator[None]:
    """Lock a folder for a command that writes there and in `inner`; remove unfinished files.

    Folders created for this are removed at the end if empty.

    Raises SceneError if another command has locked it, OSError if it is not writable.
    """
    from jointwave.compare.runs.output import sweep

    made = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        with exclusive(folder):
            TemporaryFile(dir=folder).close()  # the lock does not check that it is writable
            for each in {folder, *inner}:
                sweep(each)
            yield
    finally:
        with suppress(OSError):
            for empty in made:
                empty.rmdir()


@contextmanager
def exclusive(folder: Path, wait: bool = False) -> Iterator[None]:
    """Lock a folder, created if missing; wait : until no other process has locked it.

    The lock is on the folder itself: there is no lock file that a link could redirect (locking
    libraries all write one), and the system releases it when a process is killed.
    Raises SceneError if another process has locked it and `wait` is false.
    """
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if not wait:
                allowed = "another jointwave process is writing here; wait for it"
                raise SceneError(str(folder), "", None, allowed) from None
            log.info("waiting for another process, which times runs and has locked %s", folder)
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)
