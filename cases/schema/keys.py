"""Every table and key of a scene file, from the models that read it."""

from collections.abc import Iterator
from typing import Any, NamedTuple, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from cases.schema.allowed import model_in
from cases.schema.scene import Scene

NOT_A_KEY = {"name"}  # of a scene: only [[variants]] have one


class TableOf(NamedTuple):
    """A table of a scene file: its dotted path, empty for the top, its model, and whether there may
    be any number of it."""

    path: str
    model: type[BaseModel]
    many: bool

    @property
    def fields(self) -> list[tuple[str, FieldInfo]]:
        """The keys of this table, subtables included."""
        named = self.model.model_fields.items()
        return [(name, field) for name, field in named if self.path or name not in NOT_A_KEY]

    def dotted(self, name: str) -> str:
        """Return the full path of a key of this table."""
        return f"{self.path}.{name}".lstrip(".")

    @property
    def heading(self) -> str:
        """The line that begins the table; empty for the top of the file."""
        return (f"[[{self.path}]]" if self.many else f"[{self.path}]") if self.path else ""


def tables(path: str = "", model: type[BaseModel] = Scene, many: bool = False) -> Iterator[TableOf]:
    """Yield every table below a model, itself first, in the order of the models."""
    table = TableOf(path, model, many)
    yield table
    for name, field in model.model_fields.items():
        inner = model_in(field.annotation)
        if inner is not None:
            yield from tables(table.dotted(name), inner, get_origin(field.annotation) is list)


def keys(model: type[BaseModel] = Scene) -> Iterator[tuple[str, FieldInfo]]:
    """Yield the dotted path of every key of a scene file, without tables."""
    for table in tables(model=model):
        for name, field in table.fields:
            if not model_in(field.annotation):
                yield table.dotted(name), field


def default_of(field: FieldInfo) -> Any:
    """Return the default of a key; None if its effect is then absent."""
    value = field.get_default(call_default_factory=True)
    return None if isinstance(value, BaseModel) or value in ([], {}) else value
