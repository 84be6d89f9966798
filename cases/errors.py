"""User-facing errors: scenes that cannot be run, and runs that failed."""

import reprlib
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

CLOSE = 0.6  # difflib's least similarity of a name and its suggestion


class SceneError(ValueError):
    """A scene that cannot be simulated, in one line: where, which key and value, what is allowed.

    Parameters
    ----------
    where : the scene file (or other source) with the mistake.
    key : dotted key, `pillar.length`; empty when the mistake is not in one key.
    value : the value found, or None for a missing key.
    allowed : what is allowed, as a phrase.
    """

    def __init__(self, where: str, key: str, value: object, allowed: str) -> None:
        self.where, self.key, self.value, self.allowed = str(where), key, value, allowed
        self._arguments = (where, key, value, allowed)
        found = "" if value is None else f" = {_short(value)}"
        subject = f"{key}{found}: " if key else ""
        super().__init__(" ".join(printable(f"{where}: {subject}{allowed}").split()))

    def __reduce__(self) -> tuple:
        """Support pickling: errors are passed from worker processes."""
        return type(self), self._arguments


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the likely intended name as the end of a message; else an empty string.

    The last part of a name with folders suffices.
    """
    names = list(known)
    ends = {one.rpartition("/")[2]: one for one in reversed(names)}
    folded = {one.casefold(): one for one in [*ends, *names]}
    found = get_close_matches(name.casefold(), folded, 1, CLOSE)
    match = folded[found[0]] if found else ""
    return f"; did you mean {ends.get(match, match)}?" if match else ""


class UnstableError(RuntimeError):
    """A run stopped because it exceeded its bounds; its message gives cause and time."""


class StoppedError(UnstableError):
    """A run that could not go on; its message says why and when.

    samples : how many had been taken before. result : what was computed until then, like that of a
        whole run; None where nothing was.
    """

    samples: int = 0
    result: Any = None


class InterruptedRun(StoppedError):
    """A run stopped by the user or the system. code : exit code of the program."""

    code: int = 1


class _Found(reprlib.Repr):
    """Values as a scene file spells them, shortened."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = 60
        self.maxdict = self.maxlist = 4

    def repr_bool(self, x: bool, level: int) -> str:
        return str(x).lower()

    def repr_int(self, x: int, level: int) -> str:
        return str(x) if x.bit_length() <= 64 else f"an integer of {x.bit_length()} bits"

    def repr_datetime(self, x: object, level: int) -> str:
        return str(x)

    repr_date = repr_time = repr_datetime


_short = _Found().repr


def printable(text: str) -> str:
    """Return an external text as one safe line, without control sequences.

    Control and format characters (escape sequences, C1, DEL, direction marks) and unassigned ones
    are spelled as Python does; any kind of space, and the end of a line, is a space.
    """
    return text if text.isprintable() else "".join(map(_spelled, text))


def _spelled(one: str) -> str:
    if one.isprintable():
        return one
    return " " if one.isspace() else one.encode("unicode_escape").decode()
