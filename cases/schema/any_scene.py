"""The common base of pillars and rock masses."""

from typing import Any, ClassVar

from pydantic import PrivateAttr

from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.values import Table, Words


class SceneBase(Table):
    """A scene: its title, its times, and what is asked of it whichever way it is written.

    Attributes
    ----------
    kind : in words.
    is_column : whether it is a row of blocks along y with free sides, whose sections have an axial
        stress, not a body in two or three dimensions.
    law_tables, source_tables : which hold joint laws, and what acts over time. side_table : which
        holds the conditions of its sides.
    """

    title: Words  #: used in tables and figures
    source: Words | None = None  #: reference of the scene

    kind: ClassVar[str]
    law_tables: ClassVar[tuple[str, ...]]
    source_tables: ClassVar[tuple[str, ...]]
    side_table: ClassVar[str]
    _where: str = PrivateAttr(default="")

    def __repr__(self) -> str:
        """Return kind, file and variant: all tables would be pages."""
        return f"{type(self).__name__}({self.where!r})"

    @property
    def where(self) -> str:
        """The file and variant that the scene was read from, else its title: for messages."""
        return self._where or self.title

    @property
    def laws(self) -> dict[str, JointLaw]:
        """The joint laws by their tables, such as `joint_sets[0]`."""
        return {key: one for table in self.law_tables for key, one in self.entries(table)}

    @property
    def sides(self) -> dict[str, str]:
        """The condition of each side by its key, such as `ends.start`."""
        return {f"{self.side_table}.{side}": held for side, held in getattr(self, self.side_table)}

    def entries(self, table: str) -> list[tuple[str, Any]]:
        """Return what a table holds by its key: each of a list, none of a table it cannot have."""
        held = getattr(self, table, [])
        if isinstance(held, Table):
            return [(table, held)]
        return [(f"{table}[{i}]", one) for i, one in enumerate(held)]

    @property
    def sources(self) -> dict[str, Any]:
        """Everything that acts over time, by its table."""
        return {key: one for table in self.source_tables for key, one in self.entries(table)}

    @property
    def pulses(self) -> tuple[Any, ...]:
        """Everything that acts over time."""
        return tuple(self.sources.values())

    @property
    def bases(self: Any) -> list[Any]:
        """The loads that are the motion of a fixed side."""
        return [one for one in self.loads if self.shakes(one)]

    @property
    def pushes(self: Any) -> list[Any]:
        """The loads that are forces on the rock, those of compliant bases among them."""
        return [one for one in self.loads if not self.shakes(one)]

    def shakes(self: Any, load: Any) -> bool:
        """Return whether a load is the motion of a fixed side."""
        return load.is_motion and getattr(self.boundaries, load.side or "", None) == "fixed"

    @property
    def interval(self: Any) -> float:
        """Time between samples, s."""
        period = shortest_period(self.pulses)
        return self.record.interval or (period / 200 if period else self.time.duration / 2000)
