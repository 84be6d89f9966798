"""Types of values in a scene file, and messages for invalid values."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo
from pydantic_core import PydanticCustomError

from jointwave.cases.files import beside

#: Characters excluded from texts: control characters (C0, DEL, C1), direction marks, and those
#: invalid in XML. Tabs and line ends are allowed.
CONTROL = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f"
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]"
)


def _words(text: str) -> str:
    """Refuse a text that is unsafe in a terminal, page or drawing."""
    if found := CONTROL.search(text):
        allowed = f"must not contain the control character U+{ord(found[0]):04X}"
        raise PydanticCustomError("words", "{allowed}", {"allowed": allowed})
    return text


def _magnitude(value: float) -> float:
    """Refuse numbers outside any unit system; their squares overflow or vanish."""
    if value and not 1e-30 <= abs(value) <= 1e30:
        raise PydanticCustomError("magnitude", "must lie between 1e-30 and 1e30 in magnitude")
    return value


def _pair(text: str) -> str:
    """Check the form of a key of [expect]; `cases` does not know the solvers' names."""
    one, _, other = text.partition(" ~ ")
    if not one or not other or one == other:
        raise PydanticCustomError("pair", "must be 'a ~ b', two solvers by name")
    return text


def _unit(vector: list[float]) -> list[float]:
    """Refuse vectors that are not directions."""
    if abs(sum(x * x for x in vector) - 1) > 1e-9:
        raise PydanticCustomError("unit", "must be a unit vector")
    return vector


def _increasing(pair: list[float]) -> list[float]:
    """Refuse a start and end that are not increasing."""
    if not pair[0] < pair[1]:
        raise PydanticCustomError("increasing", "must be two increasing numbers")
    return pair


def dimension(info: ValidationInfo) -> int:
    """Return the dimension of the scene that a value belongs to: 2, or 3 in space."""
    return int((info.context or {}).get("dimension", 2))


def _per_axis(vector: list[float], info: ValidationInfo) -> list[float]:
    """Refuse vectors whose dimension is not the domain's."""
    if len(vector) != dimension(info):
        where = "in space" if dimension(info) == 3 else "in the plane"
        context = {"allowed": f"{dimension(info)} numbers: the domain is {where}"}
        raise PydanticCustomError("axes", "must have {allowed}", context)
    return vector


#: Constraints of a list.
Two = Field(min_length=2, max_length=2)
Increasing = AfterValidator(_increasing)

Words = Annotated[str, AfterValidator(_words)]
Number = Annotated[float, AfterValidator(_magnitude)]
Positive = Annotated[float, Field(gt=0), AfterValidator(_magnitude)]
NonNegative = Annotated[float, Field(ge=0), AfterValidator(_magnitude)]
Dip = Annotated[float, Field(ge=-180, le=180)]
DipDirection = Annotated[float, Field(ge=0, le=360)]
Poisson = Annotated[float, Field(gt=-1, lt=0.5)]
Offset = Annotated[list[Number], Two]
Point = Annotated[list[Number], AfterValidator(_per_axis)]  #: of a rock mass
UnitVector = Annotated[list[Number], AfterValidator(_per_axis), AfterValidator(_unit)]
Direction = Annotated[list[Number], Field(min_length=3, max_length=3), AfterValidator(_unit)]
Pair = Annotated[str, AfterValidator(_pair)]


class Table(BaseModel):
    """A table of the scene file: immutable, no unknown keys, no silent conversions, no NaN."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False, defer_build=True
    )

    def gives(self, key: str) -> bool:
        """Return whether a key differs from its default."""
        default = type(self).model_fields[key].get_default(call_default_factory=True)
        return bool(getattr(self, key) != default)


def contradiction(key: str, value: object, allowed: str) -> PydanticCustomError:
    """Return the error for a value that contradicts the rest of the scene (full key), or of its own
    table (`.key`).

    The reader prefixes the table's path to `.key`, and inserts it for `{table}` in what is allowed.
    """
    return PydanticCustomError(
        "contradiction", "{allowed}", {"allowed": allowed, "key": key, "found": value}
    )


def check_dimension(
    table: Table, info: ValidationInfo, space: tuple[str, ...] = (), plane: tuple[str, ...] = ()
) -> bool:
    """Refuse keys that have no meaning in the scene's dimension; return whether it is in space."""
    in_space = dimension(info) == 3
    for key in plane if in_space else space:
        if table.gives(key):
            allowed = f"has no meaning in {'space' if in_space else 'the plane'}"
            raise contradiction(f".{key}", getattr(table, key), allowed)
    return in_space


def named_file(info: ValidationInfo, key: str, name: str) -> Path:
    """Return the path of a file named by a key, relative to the scene's folder. It may lie outside
    if the user gave this key, or a table that holds it, directly."""
    context = info.context or {}
    asked = any(f"{key}.".startswith(f"{given}.") for given in context.get("asked", ()))
    try:
        return beside(context.get("folder", "."), name, asked)
    except ValueError as error:
        raise contradiction(f".{key.rpartition('.')[2]}", name, str(error)) from None


def check_keys(table: Table, by: str, known: Mapping[str, tuple[set[str], set[str]]]) -> None:
    """Refuse a table that lacks a key that its kind needs, or has one of other kinds only.

    by : key that names the kind. known : for each kind, required and optional keys.
    """
    kind = getattr(table, by)
    needed, taken = known[kind]
    for key in sorted(set().union(*(keys for both in known.values() for keys in both))):
        value = getattr(table, key)
        if key in needed and value is None:
            raise contradiction(f".{key}", None, f"is required for {{table}}.{by} = '{kind}'")
        if value is not None and key not in needed | taken:
            raise contradiction(f".{key}", value, f"has no meaning for {by} '{kind}'")
