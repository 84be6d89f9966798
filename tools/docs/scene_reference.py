"""The reference of all keys of a scene file, from the models that read it."""

import inspect
from typing import Any, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from jointwave.cases.schema.keys import SOLVERS, TableOf, field_comments, in_words, model_in, tables
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import names

HEAD = "| key | allowed | default | meaning |\n| --- | --- | --- | --- |"


def page(model: type[BaseModel] = Scene, prefix: str = "") -> str:
    """Return the reference of a kind of scene, a section per table in the order of the models.
    prefix : of the anchors, so that both kinds fit on one page."""
    return "\n\n".join(_section(table, prefix) for table in tables(model=model))


def _section(table: TableOf, prefix: str) -> str:
    shown = f"`{table.heading}`" if table.path else "Top of the file"
    comments = field_comments(table.model)
    rows = [_row(table.dotted(name), name, f, comments[name], prefix) for name, f in table.fields]
    anchor = f'<a id="{_anchor(table.path, prefix)}"></a>'
    return "\n".join(
        [anchor, "", f"### {shown}", "", inspect.getdoc(table.model) or "", "", HEAD, *rows]
    )


def _row(key: str, name: str, field: FieldInfo, comment: str, prefix: str) -> str:
    inner, shown = model_in(field.annotation), f'<span id="{prefix}key-{key}"></span>`{name}`'
    if inner is not None:
        link = f"[below](#{_anchor(key, prefix)})"
        return f"| {shown} | {in_words_of_table(field)} | {_default(field)} | {link} |"
    meaning = comment.replace("|", "\\|")
    allowed = in_words(field).replace(f"two {SOLVERS}", f"a and b of: {', '.join(names())}")
    return f"| {shown} | {allowed} | {_default(field)} | {meaning} |"


def in_words_of_table(field: FieldInfo) -> str:
    """Return whether a key holds one table or a list of tables, in words."""
    return "any number of tables" if get_origin(field.annotation) is list else "table"


def _anchor(path: str, prefix: str) -> str:
    return prefix + ("table-" + path.replace(".", "-") if path else "top")


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value = field.get_default(call_default_factory=True)
    absent = value is None or isinstance(value, BaseModel) or value in ([], {})
    return "absent" if absent else f"`{_toml(value)}`"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)
