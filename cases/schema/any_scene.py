"""What pillars and rock masses share."""

from typing import Any

from pydantic import PrivateAttr

from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.values import Table, Words


class SceneBase(Table):
    """A scene: its title and its times."""

    title: Words  #: used in tables and figures
    source: Words | None = None  #: reference of the scene

    _where: str = PrivateAttr(default="")

    def __repr__(self) -> str:
        """Return kind, file and variant: all tables would be pages."""
        return f"{type(self).__name__}({self.where!r})"

    @property
    def where(self) -> str:
        """The file and variant that the scene was read from, else its title: for messages."""
        return self._where or self.title

    @property
    def pulses(self: Any) -> tuple:
        """Everything that acts over time."""
        return tuple(self.sources.values())

    @property
    def interval(self: Any) -> float:
        """Time between samples, s."""
        period = shortest_period(self.pulses)
        return self.record.interval or (period / 200 if period else self.time.duration / 2000)
