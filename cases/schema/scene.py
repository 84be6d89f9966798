"""The scene vocabulary: everything that can be said about a jointed rock pillar and its load.

One pydantic model per TOML table. SI units throughout; y runs along the pillar from the loaded
end, x and z across. The reference scene is that of Guo & Li (2002), Chin. J. Rock Mech. Eng.
21(8), 1124-1129.
"""

from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import PrivateAttr

from jointwave.cases.schema.damping import Damping
from jointwave.cases.schema.joint import JointLaw, Joints, SoftLayer
from jointwave.cases.schema.law_parts import under
from jointwave.cases.schema.pulse import NO_LOAD, Load, shortest_period
from jointwave.cases.schema.segment import Part, Segment, parts_of
from jointwave.cases.schema.tables import (
    LEAN,
    Ends,
    Gravity,
    Motion,
    Numerics,
    Pillar,
    Prestress,
    Record,
    Rock,
    Scatter,
    Time,
)
from jointwave.cases.schema.values import Pair, Positive, Table, Words


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


class Scene(SceneBase):
    """A pillar scene: rock, joints, load and receivers."""

    pillar: Pillar
    rock: Rock
    motion: Motion = Motion()
    joints: Joints = Joints()
    soft_layers: list[SoftLayer] = []
    segments: list[Segment] = []
    scatter: Scatter | None = None
    load: Load = NO_LOAD
    ends: Ends = Ends()
    damping: Damping = Damping()
    gravity: Gravity | None = None
    prestress: Prestress | None = None
    time: Time
    numerics: Numerics = Numerics()
    record: Record
    #: bounds on the relative L2 misfit of pairs, that of the worst waveform. `a ~ b: velocity`: of
    #: the worst of one quantity of the results; `a ~ b: PPV`, `a ~ b: peak stress`: on the relative
    #: difference of peaks, at the receiver where it is largest
    expect: dict[Pair, Positive] = {}
    name: str = ""  #: of the variant; empty for the base scene

    kind: ClassVar[str] = "pillar"
    is_column: ClassVar[Literal[True]] = True
    law_tables: ClassVar[tuple[str, ...]] = ("joints", "soft_layers")
    source_tables: ClassVar[tuple[str, ...]] = ("load",)
    side_table: ClassVar[str] = "ends"
    #: As of a rock mass that has none.
    in_plane: ClassVar[Literal[False]] = False
    in_space: ClassVar[Literal[False]] = False
    excavated: ClassVar[Literal[False]] = False
    waves: ClassVar[tuple[()]] = ()
    joint_sets: ClassVar[tuple[()]] = ()
    regions: ClassVar[tuple[()]] = ()

    @property
    def rotation(self) -> str:
        """The rotations of blocks that are computed: "none", "small" or "finite"."""
        return self.motion.rotation

    @property
    def mesh_path(self) -> Path | None:
        """The file of the rock's cells, None where they are built."""
        return self.numerics.continuum.mesh_path

    @property
    def reach(self) -> float:
        """Its length, m."""
        return self.pillar.length

    @property
    def loads(self) -> list[Load]:
        """The load, where there is one."""
        return [self.load] if self.load.amplitude else []

    @property
    def shakes_base(self) -> bool:
        """Whether the load is the motion of a rigid base, on which the start is fixed."""
        return self.shakes(self.load)

    @property
    def boundaries(self) -> Ends:
        """The conditions of its sides, which are its ends."""
        return self.ends

    @property
    def bears(self) -> tuple[bool, bool]:
        """Whether the start and the end, which waves pass, bear what gravity puts on them."""
        if self.gravity is None or not self.gravity.acceleration:
            return False, False
        kinds, along = (self.ends.start, self.ends.end), self.gravity.direction[1]
        start, end = (kind in ("quiet", "matched") for kind in kinds)
        return start and along < LEAN, end and along > -LEAN

    @property
    def block_count(self) -> int:
        """Number of blocks N."""
        return sum(one.blocks for one in self.parts)

    @property
    def parts(self) -> list[Part]:
        """The parts between which rock or joints differ, from the loaded end on: one without
        segments."""
        return parts_of(self.pillar, self.segments)

    def alone(self, part: Part) -> "Scene":
        """Return a part as a scene of one rock without soft layers; it is not checked."""
        update: dict[str, Any] = {"segments": [], "soft_layers": [], "scatter": None}
        side, length = self.pillar.side, part.stop - part.start  # one block will do
        block = length / part.blocks
        update["pillar"] = Pillar.model_construct(length=length, side=side, block=block)
        if part.segment is not None:
            one = self.segments[part.segment]
            update |= {"rock": one.rock(self.rock), "joints": one.law(self.joints)}
        return self.model_copy(update=update)

    @property
    def is_uniform(self) -> bool:
        """Whether all blocks are equal, and all joints except the soft layers."""
        return not self.segments and self.scatter is None

    @property
    def layers(self) -> list[SoftLayer]:
        """The soft layers, each with what it takes from [joints]."""
        return [under(layer, self.joints) for layer in self.soft_layers]
