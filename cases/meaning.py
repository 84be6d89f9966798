"""The comments `#: text` that say what a model's fields mean, read from its source."""

import ast
import inspect
from textwrap import dedent


def field_comments(model: type) -> dict[str, str]:
    """Return what the comments say of each field that a model, or one that it extends, defines."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if "__annotations__" in vars(base) and base.__module__.split(".")[0] == "cases":
            found |= _own(dedent(inspect.getsource(base)))
    return found


def _own(source: str) -> dict[str, str]:
    lines = source.splitlines()
    fields = [node for node in ast.parse(source).body[0].body if isinstance(node, ast.AnnAssign)]
    return {field.target.id: _above(lines, field) or _beside(lines, field) for field in fields}


def _beside(lines: list[str], field: ast.AnnAssign) -> str:
    return lines[field.end_lineno - 1][field.end_col_offset :].partition("#:")[2].strip()


def _above(lines: list[str], field: ast.AnnAssign) -> str:
    first = field.lineno - 1
    while lines[first - 1].strip().startswith("#:"):
        first -= 1
    return " ".join(line.strip()[2:].strip() for line in lines[first : field.lineno - 1])
