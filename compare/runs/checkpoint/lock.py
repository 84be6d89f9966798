"""One run at a time in a folder of results."""

from __future__ import annotations

import fcntl
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import ELOOP
from pathlib import Path

from cases.errors import SceneError
from compare.runs.output import sweep

NAME = ".jointwave.lock"
ELSE = "remove it: jointwave locks a file of its own there"


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


def opened(place: Path) -> int:
    """Return an open file to lock; raises SceneError where anything but a file is in its place.

    Whoever may write there could have put a link, which would be followed, or a pipe.
    """
    flags = os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        # Where all may write, creating what another user has created already is forbidden.
        handle = os.open(place, os.O_RDONLY | flags)
    except FileNotFoundError:
        handle = os.open(place, os.O_RDONLY | os.O_CREAT | flags, 0o644)
    except OSError as error:
        if error.errno != ELOOP:
            raise
        raise SceneError(str(place), "", None, f"is a link, {ELSE}") from None
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return handle
    os.close(handle)
    raise SceneError(str(place), "", None, f"is no file, {ELSE}")


def _hold(place: Path) -> int:
    """Return the open and locked file."""
    while True:
        handle = opened(place)
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
