"""Columns selected by `--with`: FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL.

COLUMN is a header of the file, or in a table of `jointwave compare --out`, whose headers are
`solution | place | variant (unit)`, one or more of these parts.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from cases.records import Column
from cases.units import split_unit
from compare.misfit.places import WORDS, parsed

PART = " | "  # separator of the parts of jointwave's headers
TIME = "time"


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
        if split_unit(self.column) == (column.name, column.unit):
            return True
        parts = parts_of(column.name)
        return len(parts) > 1 and set(parts_of(self.column)) <= set(parts)


class Exported(NamedTuple):
    """The parts of jointwave's headers: solution, receiver as a label, and variant."""

    solution: str
    label: str
    variant: str


def asked(text: str, is_label: Callable[[str], bool]) -> Asked:
    """Return a parsed argument; a file that does not exist can only have a label."""
    if Path(text).exists():
        return Asked(text, Path(text))
    colons = [i for i, letter in enumerate(text) if letter == ":"]
    found = next((i for i in colons if Path(text[:i]).is_file()), None)
    if found is None:
        file, _, label = text.rpartition(":")
        return (
            Asked(text, Path(file), "", label) if file and "@" in label else Asked(text, Path(text))
        )
    path, which = Path(text[:found]), text[found + 1 :].strip()
    if is_label(which):
        return Asked(text, path, "", which)
    column, equals, label = which.rpartition("=")
    if equals and (is_label(label) or split_unit(label)[0].lower() == TIME):
        return Asked(text, path, _unquoted(column), label.strip())
    return Asked(text, path, _unquoted(which))


def exported(name: str) -> Exported | None:
    """Return the parts of one of jointwave's headers; None for others."""
    parts = parts_of(name)
    place = parsed(parts[1], WORDS) if len(parts) == 3 else None
    return None if place is None else Exported(parts[0], str(place), parts[2])


def base_of(columns: list[Column]) -> str:
    """Return the name of the base scene, the first variant, in a table of jointwave; else ""."""
    found = (exported(column.name) for column in columns)
    return next((one.variant for one in found if one is not None), "")


def parts_of(name: str) -> list[str]:
    """Return the parts of a header, variants as scenes name them."""
    return [part.strip().replace("ζ = ", "zeta ") for part in name.split(PART.strip(), 2)]


def listed(columns: list[Column]) -> str:
    """Return the names of columns, as a message lists them."""
    return ", ".join(column.name or "one column without a name" for column in columns)


def _unquoted(text: str) -> str:
    text = text.strip()
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text
