"""The reference of all keys of a scene file, from the models that read it."""

import inspect
from collections.abc import Iterator
from typing import Any, get_origin

from allowed import in_words, model_in
from comments import field_comments
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from cases.scene import Scene

HEAD = "| key | allowed | default | meaning |\n| --- | --- | --- | --- |"
NOT_A_KEY = {"name"}  # of a scene: only [[variants]] have one


def page() -> str:
    """Return the reference: a section for every table, in the order of the models."""
    return "\n\n".join(_section(path, model, many) for path, model, many in tables())


def tables(
    path: str = "", model: type[BaseModel] = Scene, many: bool = False
) -> Iterator[tuple[str, type[BaseModel], bool]]:
    """Yield the dotted path of every table, its model, and whether there may be any number."""
    yield path, model, many
    for name, field in model.model_fields.items():
        inner = model_in(field.annotation)
        if inner is not None:
            listed = get_origin(field.annotation) is list
            yield from tables(f"{path}.{name}".lstrip("."), inner, listed)


def keys() -> Iterator[str]:
    """Yield the dotted path of every key that a scene file may hold, tables left out."""
    for path, model, _ in tables():
        for name, field in _own_keys(path, model):
            if not model_in(field.annotation):
                yield f"{path}.{name}".lstrip(".")


def _own_keys(path: str, model: type[BaseModel]) -> list[tuple[str, FieldInfo]]:
    fields = model.model_fields.items()
    return [(name, field) for name, field in fields if path or name not in NOT_A_KEY]


def _section(path: str, model: type[BaseModel], many: bool) -> str:
    heading = (f"[[{path}]]" if many else f"[{path}]") if path else "Top of the file"
    shown = f"`{heading}`" if path else heading
    comments = field_comments(model)
    rows = [_row(path, name, f, comments[name]) for name, f in _own_keys(path, model)]
    return "\n".join([f"### {shown} {{ #{_anchor(path)} }}", "", _purpose(model), "", HEAD, *rows])


def _purpose(model: type[BaseModel]) -> str:
    return inspect.getdoc(model) or ""


def _row(path: str, name: str, field: FieldInfo, comment: str) -> str:
    key = f"{path}.{name}".lstrip(".")
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
    value = field.get_default(call_default_factory=True)
    if value is None or isinstance(value, BaseModel) or value in ([], {}):
        return "absent"
    return f"`{_toml(value)}`"


def _toml(value: Any) -> str:
    assert value is not PydanticUndefined
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)
