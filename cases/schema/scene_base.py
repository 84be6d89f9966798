"""The base of all scenes: title, sources, sides and receivers, and views for engines."""

from typing import Any, ClassVar

import numpy as np
from pydantic import PrivateAttr

from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.values import Table, Words


class SceneBase(Table):
    """What pillars and rock masses share: title, time, loads and sides.

    kind : as text.
    is_column : whether it is a row of blocks along y with free sides and an axial stress in each
        section, not a body in two or three dimensions.
    axes : of the coordinates of receivers.
    off_axis : why the motion is not axial; None if it is.
    law_tables, source_tables : tables of joint laws, and of loads and waves. side_table : table of
        boundary conditions.
    """

    title: Words  #: used in tables and figures
    source: Words | None = None  #: reference of the scene

    kind: ClassVar[str]
    law_tables: ClassVar[tuple[str, ...]]
    source_tables: ClassVar[tuple[str, ...]]
    side_table: ClassVar[str]
    _where: str = PrivateAttr(default="")

    def __repr__(self) -> str:
        """Return kind, file and variant, as all tables would fill pages."""
        return f"{type(self).__name__}({self.where!r})"

    @property
    def where(self) -> str:
        """File and variant of the scene, else its title, for messages."""
        return self._where or self.title

    @property
    def in_plane(self: Any) -> bool:
        """Whether receivers are in the plane."""
        return len(self.axes) == 2

    @property
    def in_space(self: Any) -> bool:
        """Whether receivers are in space."""
        return len(self.axes) == 3

    @property
    def is_spatial(self: Any) -> bool:
        """Whether it moves across an axis or rotates its blocks; else it is axial."""
        return self.off_axis is not None

    @property
    def block_freedoms(self: Any) -> int:
        """Degrees of freedom of a rigid block."""
        if not self.is_spatial:
            return 1
        return 3 if self.in_plane or self.rotation == "none" else 6

    @property
    def laws(self) -> dict[str, JointLaw]:
        """The joint laws by table, such as `joint_sets[0]`."""
        return {key: one for table in self.law_tables for key, one in self.entries(table)}

    @property
    def sides(self) -> dict[str, str]:
        """The boundary condition of each side by key, such as `ends.start`."""
        return {f"{self.side_table}.{side}": held for side, held in getattr(self, self.side_table)}

    def entries(self, table: str) -> list[tuple[str, Any]]:
        """Return the entries of a table by key: one for each of a list, none if it is absent."""
        held = getattr(self, table, [])
        if isinstance(held, Table):
            return [(table, held)]
        return [(f"{table}[{i}]", one) for i, one in enumerate(held)]

    @property
    def sources(self) -> dict[str, Any]:
        """All loads and waves, by table."""
        return {key: one for table in self.source_tables for key, one in self.entries(table)}

    @property
    def pulses(self) -> tuple[Any, ...]:
        """All loads and waves."""
        return tuple(self.sources.values())

    @property
    def bases(self: Any) -> list[Any]:
        """The loads that are the motion of a fixed side."""
        return [one for one in self.loads if self.shakes(one)]

    @property
    def pushes(self: Any) -> list[Any]:
        """The loads that are forces on the rock, including those of compliant bases."""
        return [one for one in self.loads if not self.shakes(one)]

    def shakes(self: Any, load: Any) -> bool:
        """Return whether a load is the motion of a fixed side."""
        return load.is_motion and getattr(self.boundaries, load.side or "", None) == "fixed"

    @property
    def places(self: Any) -> dict[str, np.ndarray]:
        """The receivers [n, axes] by key of [record], m."""
        every = {key: places for key, places in self.record if isinstance(places, list)}
        shape = -1, len(self.axes)
        return {key: np.array(at, dtype=float).reshape(shape) for key, at in every.items()}

    @property
    def interval(self: Any) -> float:
        """Time between samples, s."""
        period = shortest_period(self.pulses)
        return self.record.interval or (period / 200 if period else self.time.duration / 2000)
