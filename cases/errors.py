"""The errors that a user meets: a scene that cannot be run, a run that went wrong."""

import reprlib
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

CLOSE = 0.6  # of difflib: how alike a name and the one that is suggested are


class SceneError(ValueError):
    """A scene that cannot be simulated, in one line: where, which key and value, what is allowed.

    Parameters
    ----------
    where : the scene file (or other source) that holds the mistake.
    key : dotted key, `pillar.length`; empty when the mistake is not in one key.
    value : the value that was found, or None when a key is missing or absent.
    allowed : what would be accepted, as a phrase.
    """

    def __init__(self, where: str, key: str, value: object, allowed: str) -> None:
        self.where, self.key, self.value, self.allowed = str(where), key, value, allowed
        self._arguments = (where, key, value, allowed)
        found = "" if value is None else f" = {_short(value)}"
        subject = f"{key}{found}: " if key else ""
        super().__init__(" ".join(printable(f"{where}: {subject}{allowed}").split()))

    def __reduce__(self) -> tuple:
        """Return how to make it again: it crosses from worker processes."""
        return type(self), self._arguments


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name that one was likely meant as, as the end of a message; else nothing.

    Of names with folders the last part alone may be given.
    """
    names = list(known)
    ends = {one.rpartition("/")[2]: one for one in reversed(names)}
    folded = {one.casefold(): one for one in [*ends, *names]}
    found = get_close_matches(name.casefold(), folded, 1, CLOSE)
    match = folded[found[0]] if found else ""
    return f"; did you mean {ends.get(match, match)}?" if match else ""


class UnstableError(RuntimeError):
    """A run that left its stability bound and was stopped; its message says what and when."""


class StoppedError(UnstableError):
    """A run that could not go on; its message says why and when.

    samples : how many had been taken before. result : what was computed until then, like that of a
        whole run; None where nothing was.
    """

    samples: int = 0
    result: Any = None


class InterruptedRun(StoppedError):
    """A run that was asked to stop, by the user or the machine."""


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
    """Return a text of others as one line that moves no cursor and hides nothing.

    Control and format characters (escape sequences, C1, DEL, direction marks) and unassigned ones
    are spelled as Python does; any kind of space, and the end of a line, is a space.
    """
    return text if text.isprintable() else "".join(map(_spelled, text))


def _spelled(one: str) -> str:
    if one.isprintable():
        return one
    return " " if one.isspace() else one.encode("unicode_escape").decode()
