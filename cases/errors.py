"""User-facing errors: scenes that cannot be run, and runs that failed."""

import reprlib
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Any

CLOSE = 0.6  # least similarity (difflib) between a name and its suggestion


class SceneError(ValueError):
    """A scene that cannot be simulated; one line per mistake with place, key, value and what is
    allowed.

    where : the scene file (or other source) with the mistake.
    key : dotted key, `pillar.length`; empty if the mistake is not in one key.
    value : the value found, or None for a missing key.
    allowed : what is allowed, as a phrase.
    others : further mistakes, whose lines follow.
    """

    def __init__(
        self, where: str, key: str, value: object, allowed: str, others: "Sequence[SceneError]" = ()
    ) -> None:
        self.where, self.key, self.value, self.allowed = str(where), key, value, allowed
        self._arguments = (where, key, value, allowed, others)
        found = "" if value is None else f" = {_short(value)}"
        subject = f"{key}{found}: " if key else ""
        own = " ".join(printable(f"{where}: {subject}{allowed}").split())
        super().__init__("\n".join([own, *map(str, others)]))

    def __reduce__(self) -> tuple:
        """Support pickling: worker processes pass errors on."""
        return type(self), self._arguments

    @property
    def each(self) -> "list[SceneError]":
        """All mistakes one by one, this one first."""
        own = SceneError(*self._arguments[:4])
        return [own, *(one for other in self._arguments[4] for one in other.each)]


def require(value: object, kind: Any, where: str, key: str, allowed: str) -> None:
    """Raise SceneError unless a caller's value has the required type."""
    if not isinstance(value, kind):
        raise SceneError(where, key, type(value).__name__, f"must be {allowed}")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return "; did you mean ...?" for the likely name, whose last part is enough, or ""."""
    names = list(known)
    ends = {one.rpartition("/")[2]: one for one in reversed(names)}
    folded = {one.casefold(): one for one in [*ends, *names]}
    found = get_close_matches(name.casefold(), folded, 1, CLOSE)
    match = folded[found[0]] if found else ""
    return f"; did you mean {ends.get(match, match)}?" if match else ""


class UnstableError(RuntimeError):
    """A run that stopped because it exceeded its bounds; the message gives cause and time."""


class StoppedError(UnstableError):
    """A run that could not continue; the message gives cause and time.

    samples : number of samples taken before. result : the result up to then; None without any.
    """

    samples: int = 0
    result: Any = None


class InterruptedRun(StoppedError):
    """A run stopped by the user or the system. code : exit code of the program."""

    code: int = 1


def all_of(errors: Iterable[SceneError]) -> SceneError:
    """Return several errors as one, without the repetitions from variants."""
    said: dict[tuple[str, str, str], SceneError] = {}
    for one in (one for error in errors for one in error.each):
        said.setdefault((one.key, repr(one.value), one.allowed), one)
    first, *others = said.values()
    return SceneError(first.where, first.key, first.value, first.allowed, others)


class _ShortRepr(reprlib.Repr):
    """Shortened values, spelled as in a scene file."""

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

    def repr_instance(self, x: Any, level: int) -> str:
        """Return an inline table of the keys that were given, or a number of numpy."""
        if hasattr(x, "item"):
            return self.repr1(x.item(), level)
        if (given := getattr(x, "model_fields_set", None)) is None:
            return super().repr_instance(x, level)
        keys = [f"{k} = {self.repr1(v, level - 1)}" for k, v in x if k in given]
        return f"{{{', '.join(keys)}}}"


_short = _ShortRepr().repr


def placed(place: Iterable[float], digits: int = 6) -> str:
    """Return a place as text, "[20, 30]"."""
    return f"[{', '.join(f'{x:.{digits}g}' for x in place)}]"


def printable(text: str) -> str:
    """Return external text as one safe line without control sequences.

    Control and format characters (escape sequences, C1, DEL, direction marks) and unassigned ones
    are escaped as in Python; any white space becomes a space.
    """
    return text if text.isprintable() else "".join(map(_escaped, text))


def _escaped(one: str) -> str:
    if one.isprintable():
        return one
    return " " if one.isspace() else one.encode("unicode_escape").decode()
