"""The comments `#: text` that describe a model's fields, read from its source."""

import ast
import inspect
from collections.abc import Mapping
from functools import cache
from textwrap import dedent

#: The package that defines all models.
CASES = __name__.rpartition(".schema.")[0]


@cache
def field_comments(model: type) -> Mapping[str, str]:
    """Return the comment of each field of a model, inherited fields included."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if "__annotations__" in vars(base) and base.__module__.startswith(CASES):
            found |= _own(dedent(inspect.getsource(base)))
    return found


def _own(source: str) -> dict[str, str]:
    lines = source.splitlines()
    (model,) = ast.parse(source).body
    assert isinstance(model, ast.ClassDef)
    return {
        field.target.id: _above(lines, field) or _beside(lines, field)
        for field in model.body
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
    }


def _beside(lines: list[str], field: ast.AnnAssign) -> str:
    assert field.end_lineno is not None
    return lines[field.end_lineno - 1][field.end_col_offset :].partition("#:")[2].strip()


def _above(lines: list[str], field: ast.AnnAssign) -> str:
    first = field.lineno - 1
    while lines[first - 1].strip().startswith("#:"):
        first -= 1
    return " ".join(line.strip()[2:].strip() for line in lines[first : field.lineno - 1])
