"""One run at a time in a folder of results."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from cases.errors import SceneError
from compare.output import sweep

NAME = ".jointwave.lock"


@contextmanager
def locked(folder: Path, *inner: Path) -> Iterator[None]:
    """Hold a folder for one command that writes results there and in `inner`, and sweep them.

    The system lets go of the lock of a process that is killed. A folder that is made for this, and
    left empty, is removed at the end.

    Raises SceneError where another command holds it, OSError where nothing can be written there.
    """
    made = [place for place in (folder, *folder.parents) if not place.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / NAME
    try:
        handle = _hold(place)
        try:
            for each in {folder, *inner}:
                sweep(each)
            yield
        finally:
            place.unlink(missing_ok=True)
            os.close(handle)
    finally:
        with suppress(OSError):
            for empty in made:
                empty.rmdir()


def _hold(place: Path) -> int:
    """Return the open and locked file."""
    while True:
        handle = os.open(place, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise SceneError(
                str(place.parent), "", None, "another jointwave is writing here; wait for it"
            ) from None
        # Whoever held it may have removed it in between: then this is a file that nobody sees.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), place.stat()):
                return handle
        os.close(handle)
