"""Tables and keys of a scene file, with meanings and allowed values taken from the models."""

import inspect
import re
from collections.abc import Iterator, Mapping
from functools import cache
from textwrap import dedent
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from jointwave.cases.schema.scene import Scene

NOT_A_KEY = {"name"}  # only [[variants]] have it

#: The package that defines all models.
CASES = __name__.rpartition(".schema.")[0]

#: Word for the members of a pair in [expect]; `cases` does not know their names.
SOLVERS = "solvers"
WORDS = {float: "number", int: "whole number", str: "string", bool: "`true` or `false`"}
BOUNDS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
LENGTHS = {"min_length": "at least", "max_length": "at most"}
FIELD = re.compile(r"    (\w+): ")  # a field of a model
#: Wording of validators' requirements; empty for bounds that only exclude nonsense.
CHECKS = {"_magnitude": "", "_words": ""} | {
    "_unit": "of length 1",
    "_per_axis": "one for each axis",
    "_increasing": "increasing",
}


class TableOf(NamedTuple):
    """A table of a scene file: dotted path (empty for the top), model, whether it repeats."""

    path: str
    model: type[BaseModel]
    many: bool

    @property
    def fields(self) -> list[tuple[str, FieldInfo]]:
        """The keys of this table, including subtables."""
        named = self.model.model_fields.items()
        return [(name, field) for name, field in named if self.path or name not in NOT_A_KEY]

    def dotted(self, name: str) -> str:
        """Return the full path of a key of this table."""
        return f"{self.path}.{name}".lstrip(".")

    @property
    def heading(self) -> str:
        """The heading of the table in a file; empty for the top level."""
        return (f"[[{self.path}]]" if self.many else f"[{self.path}]") if self.path else ""


def tables(path: str = "", model: type[BaseModel] = Scene, many: bool = False) -> Iterator[TableOf]:
    """Yield every table of a model, itself first, in the order of the models."""
    table = TableOf(path, model, many)
    yield table
    for name, field in model.model_fields.items():
        inner = model_in(field.annotation)
        if inner is not None:
            yield from tables(table.dotted(name), inner, get_origin(field.annotation) is list)


def keys(model: type[BaseModel] = Scene) -> Iterator[tuple[str, FieldInfo]]:
    """Yield the dotted path of every key of a scene file, except tables."""
    for table in tables(model=model):
        for name, field in table.fields:
            if not model_in(field.annotation):
                yield table.dotted(name), field


@cache
def field_comments(model: type) -> Mapping[str, str]:
    """Return the comment above or after each field of a model, including inherited fields."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        above: list[str] = []
        own = base.__module__.startswith(CASES) and "__annotations__" in vars(base)
        for line in dedent(inspect.getsource(base)).splitlines() if own else ():
            code, _, comment = line.partition("#:")
            if comment and not code.strip():
                above.append(comment.strip())
                continue
            if field := FIELD.match(code):
                found[field[1]] = " ".join(above) or comment.strip()
            above = []
    return found


def in_words(field: FieldInfo) -> str:
    """Return the allowed values of a field as text; KeyError for an unknown type or check."""
    return _words(field.annotation, field.metadata)


def model_in(annotation: Any) -> type[BaseModel] | None:
    """Return the model of a field, or of the items of its list, if any."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((m for part in get_args(annotation) if (m := model_in(part))), None)


def _words(kind: Any, constraints: list) -> str:
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _words(parts[0], [*constraints, *parts[1:]])
    if origin in (Union, UnionType):
        return " or ".join(_words(part, constraints) for part in parts if part is not NoneType)
    if origin is Literal:
        return ", ".join(f'`"{value}"`' for value in parts)
    if model := model_in(kind):
        return "tables" if origin is list else f"table `{model.__name__}`"
    if origin is dict:
        return f'`"a ~ b" = {_words(parts[1], [])}`, two {SOLVERS}'
    # Field(ge=1, le=4) contains several constraints.
    flat = [x for c in constraints for x in (c.metadata if isinstance(c, FieldInfo) else [c])]
    named = [CHECKS[c.func.__name__] for c in flat if hasattr(c, "func")]
    checks = "".join(f", {words}" for words in named if words)
    if origin is list:
        noun, space, rest = _words(parts[0], []).partition(" ")
        return f"list of {_count(flat)}{noun}s{space}{rest}{checks}"
    bounds = [(sign, getattr(c, k)) for c in flat for k, sign in BOUNDS.items() if hasattr(c, k)]
    return WORDS[kind] + " and".join(f" {sign} {value:g}" for sign, value in bounds) + checks


def _count(flat: list) -> str:
    found = {k: getattr(c, k) for c in flat for k in LENGTHS if hasattr(c, k)}
    if len(set(found.values())) == 1 and len(found) == 2:
        return f"{found['min_length']} "
    return "".join(f"{LENGTHS[k]} {n} " for k, n in found.items())
