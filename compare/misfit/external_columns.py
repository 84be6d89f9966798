"""Columns selected by `--with`: FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from jointwave.cases.records import Column
from jointwave.cases.units import split_unit
from jointwave.compare.misfit.places import Place, parsed

TIME = "time"


class Heading(NamedTuple):
    """What a header says: the place, None if it names none, and the sign of the values."""

    place: Place | None
    sign: float = 1.0


class Asked(NamedTuple):
    """One argument of `--with`: column and label are empty if not given."""

    text: str
    path: Path
    column: str = ""
    label: str = ""

    @property
    def is_time(self) -> bool:
        """Whether it selects the column of times."""
        return split_unit(self.label)[0].lower() == TIME

    def fits(self, column: Column) -> bool:
        """Return whether a column's name matches the argument."""
        if self.column in (column.name, f"{column.name} [{column.unit}]"):
            return True
        return split_unit(self.column) == (column.name, column.unit)


def asked(text: str, is_label: Callable[[str], bool]) -> Asked:
    """Return a parsed argument; a file that does not exist can only have a label."""
    if Path(text).exists():
        return Asked(text, Path(text))
    colons = [i for i, letter in enumerate(text) if letter == ":"]
    found = next((i for i in colons if Path(text[:i]).is_file()), None)
    if found is None:
        file, _, label = text.rpartition(":")
        known = bool(file) and "@" in label
        return Asked(text, Path(file), "", label) if known else Asked(text, Path(text))
    path, which = Path(text[:found]), text[found + 1 :].strip()
    if is_label(which):
        return Asked(text, path, "", which)
    column, equals, label = which.rpartition("=")
    if not equals or not (is_label(label) or split_unit(label)[0].lower() == TIME):
        column, label = which, ""
    column = column.strip()
    quoted = len(column) > 1 and column[0] == column[-1] and column[0] in "\"'"
    return Asked(text, path, column[1:-1] if quoted else column, label.strip())


def heading(name: str) -> Heading:
    """Return what a header says: `[-]QUANTITY[_COMPONENT]@PLACE`."""
    text = name.strip()
    return Heading(parsed(text.removeprefix("-").lstrip()), -1.0 if text.startswith("-") else 1.0)
