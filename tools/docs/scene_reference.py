"""The reference of all keys of a scene file, from the models that read it."""

import inspect
from typing import Any, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from cases.schema.allowed import in_words, model_in
from cases.schema.field_docs import field_comments
from cases.schema.keys import TableOf, default_of, tables

HEAD = "| key | allowed | default | meaning |\n| --- | --- | --- | --- |"


def page() -> str:
    """Return the reference: a section for every table, in the order of the models."""
    return "\n\n".join(map(_section, tables()))


def _section(table: TableOf) -> str:
    shown = f"`{table.heading}`" if table.path else "Top of the file"
    comments = field_comments(table.model)
    rows = [_row(table.dotted(name), name, f, comments[name]) for name, f in table.fields]
    heading = f"### {shown} {{ #{_anchor(table.path)} }}"
    return "\n".join([heading, "", _purpose(table.model), "", HEAD, *rows])


def _purpose(model: type[BaseModel]) -> str:
    return inspect.getdoc(model) or ""


def _row(key: str, name: str, field: FieldInfo, comment: str) -> str:
    inner, shown = model_in(field.annotation), f'<span id="key-{key}"></span>`{name}`'
    if inner is not None:
        link = f"[below](#{_anchor(key)})"
        return f"| {shown} | {in_words_of_table(field)} | {_default(field)} | {link} |"
    meaning = comment.replace("|", "\\|")
    return f"| {shown} | {in_words(field)} | {_default(field)} | {meaning} |"


def in_words_of_table(field: FieldInfo) -> str:
    """Return what holds a table: one, or any number of them."""
    return "any number of tables" if get_origin(field.annotation) is list else "table"


def _anchor(path: str) -> str:
    return "table-" + path.replace(".", "-") if path else "top"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value = default_of(field)
    return "absent" if value is None else f"`{_toml(value)}`"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)
