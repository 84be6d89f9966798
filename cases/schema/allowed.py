"""Allowed values of a model's field, in words: from its type and its constraints."""

from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

#: What [expect] pairs; `cases` does not know their names.
SOLVERS = "solvers"
WORDS = {float: "number", int: "whole number", str: "string", bool: "`true` or `false`"}
BOUNDS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
LENGTHS = {"min_length": "at least", "max_length": "at most"}
#: Requirements of the functions that check a value; empty for bounds that only exclude nonsense.
CHECKS = {"_magnitude": "", "_amplitude": "", "_unit": "of length 1", "_words": ""}


def in_words(field: FieldInfo) -> str:
    """Return the allowed values of a field, in words; KeyError for an unknown type or check."""
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
    if origin is list:
        return f"list of {_count(constraints)}{_plural(_words(parts[0], []))}{_checks(constraints)}"
    return WORDS[kind] + _bounds(constraints) + _checks(constraints)


def _plural(words: str) -> str:
    noun, space, rest = words.partition(" ")
    return f"{noun}s{space}{rest}"


def _flat(constraints: list) -> list:
    """Return constraints one by one: Field(ge=1, le=4) contains several."""
    return [one for c in constraints for one in (c.metadata if isinstance(c, FieldInfo) else [c])]


def _bounds(constraints: list) -> str:
    flat = _flat(constraints)
    found = [(sign, getattr(c, k)) for c in flat for k, sign in BOUNDS.items() if hasattr(c, k)]
    return " and".join(f" {sign} {value:g}" for sign, value in found)


def _count(constraints: list) -> str:
    flat = _flat(constraints)
    found = {k: getattr(c, k) for c in flat for k in LENGTHS if hasattr(c, k)}
    if len(set(found.values())) == 1 and len(found) == 2:
        return f"{found['min_length']} "
    return "".join(f"{LENGTHS[k]} {n} " for k, n in found.items())


def _checks(constraints: list) -> str:
    named = [CHECKS[c.func.__name__] for c in _flat(constraints) if hasattr(c, "func")]
    return "".join(f", {words}" for words in named if words)
