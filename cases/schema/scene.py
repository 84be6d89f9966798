"""Model of a pillar scene.

SI units; y runs along the pillar from the loaded end, x and z across. The reference scene is that
of Guo & Li (2002), Chin. J. Rock Mech. Eng. 21(8), 1124-1129.
"""

from pathlib import Path
from typing import Any, ClassVar, Literal

from jointwave.cases.schema import tables
from jointwave.cases.schema.damping import Damping
from jointwave.cases.schema.joint import Joints, SoftLayer
from jointwave.cases.schema.law_parts import under
from jointwave.cases.schema.pulse import NO_LOAD, Load
from jointwave.cases.schema.scene_base import SceneBase
from jointwave.cases.schema.segment import Part, Segment, parts_of
from jointwave.cases.schema.values import Pair, Positive


class Scene(SceneBase):
    """A pillar scene: rock, joints, load and receivers."""

    pillar: tables.Pillar
    rock: tables.Rock
    motion: tables.Motion = tables.Motion()
    joints: Joints = Joints()
    soft_layers: list[SoftLayer] = []
    segments: list[Segment] = []
    scatter: tables.Scatter | None = None
    load: Load = NO_LOAD
    ends: tables.Ends = tables.Ends()
    damping: Damping = Damping()
    gravity: tables.Gravity | None = None
    prestress: tables.Prestress | None = None
    time: tables.Time
    numerics: tables.Numerics = tables.Numerics()
    record: tables.Record
    #: largest relative L2 misfit of each pair of solvers, over all waveforms; `a ~ b: velocity`:
    #: over those of one quantity; `a ~ b: PPV`, `a ~ b: peak stress`: largest relative difference
    #: of peaks, over all receivers
    expect: dict[Pair, Positive] = {}
    name: str = ""  #: of the variant; empty for the base scene

    kind: ClassVar[str] = "pillar"
    is_column: ClassVar[Literal[True]] = True
    axes: ClassVar[str] = "y"
    law_tables: ClassVar[tuple[str, ...]] = ("joints", "soft_layers")
    source_tables: ClassVar[tuple[str, ...]] = ("load",)
    side_table: ClassVar[str] = "ends"
    #: The same attributes as a rock mass without these.
    excavated: ClassVar[Literal[False]] = False
    waves: ClassVar[tuple[()]] = ()
    joint_sets: ClassVar[tuple[()]] = ()
    regions: ClassVar[tuple[()]] = ()

    @property
    def rotation(self) -> str:
        """Block rotations that are computed: "none", "small" or "finite"."""
        return self.motion.rotation

    @property
    def off_axis(self) -> str | None:
        """Why the motion is not axial; None if it is."""
        if self.load.arm is not None:
            return "the load is a couple"
        if self.load.is_across:
            return "the load has a component across the axis"
        if self.load.is_eccentric:
            return "the load is eccentric"
        if self.gravity is not None and (self.gravity.direction[0] or self.gravity.direction[2]):
            return "gravity has a component across the axis"
        return None

    @property
    def mesh_path(self) -> Path | None:
        """The file of the rock's cells; None if they are built."""
        return self.numerics.continuum.mesh_path

    @property
    def reach(self) -> float:
        """Length of the pillar, m."""
        return self.pillar.length

    @property
    def loads(self) -> list[Load]:
        """The load, if there is one."""
        return [self.load] if self.load.amplitude else []

    @property
    def shakes_base(self) -> bool:
        """Whether the load is the motion of a rigid base under a fixed start."""
        return self.shakes(self.load)

    def left_out(self, dim: int) -> float:
        """Return the section's extent beyond a model of `dim` dimensions, m2, m, or 1."""
        return float(self.pillar.side ** (3 - dim))

    @property
    def boundaries(self) -> tables.Ends:
        """The boundary conditions of the ends."""
        return self.ends

    @property
    def bears(self) -> tuple[bool, bool]:
        """Whether the absorbing start and end bear the weight."""
        if self.gravity is None or not self.gravity.acceleration:
            return False, False
        kinds, along = (self.ends.start, self.ends.end), self.gravity.direction[1]
        start, end = (kind in ("quiet", "matched") for kind in kinds)
        return start and along < tables.LEAN, end and along > -tables.LEAN

    @property
    def block_count(self) -> int:
        """Number of blocks N."""
        return sum(one.blocks for one in self.parts)

    @property
    def parts(self) -> list[Part]:
        """The parts with one rock each, from the loaded end on; one part without segments."""
        return parts_of(self.pillar, self.segments)

    def alone(self, part: Part) -> "Scene":
        """Return a part as an unchecked scene of one rock without soft layers."""
        update: dict[str, Any] = {"segments": [], "soft_layers": [], "scatter": None}
        side, length = self.pillar.side, part.stop - part.start  # may be a single block
        block = length / part.blocks
        update["pillar"] = tables.Pillar.model_construct(length=length, side=side, block=block)
        if part.segment is not None:
            one = self.segments[part.segment]
            update |= {"rock": one.rock(self.rock), "joints": one.law(self.joints)}
        return self.model_copy(update=update)

    @property
    def is_uniform(self) -> bool:
        """Whether all blocks are equal, and all joints except soft layers."""
        return not self.segments and self.scatter is None

    @property
    def layers(self) -> list[SoftLayer]:
        """The soft layers, with absent keys taken from [joints]."""
        return [under(layer, self.joints) for layer in self.soft_layers]
