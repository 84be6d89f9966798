"""The scene of a rock mass, in the plane or in space: a domain cut by joint sets, and its loads.

A file with a table [domain] holds one; a file with [pillar] is a `Scene`. Tables that both have
mean the same. SI units; x to the right and y upwards in plane strain, or x to the east, y to the
north and z upwards.
"""

from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from jointwave.cases.schema.any_scene import SceneBase
from jointwave.cases.schema.damping import Damping
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.plane import (
    Boundaries,
    GravityOfRock,
    InSituStress,
    IntactRock,
    NumericsOfRock,
    RecordOfRock,
    Region,
)
from jointwave.cases.schema.sources import PlaneLoad, Wave
from jointwave.cases.schema.tables import Time
from jointwave.cases.schema.values import Pair, Positive


class RockMass(SceneBase):
    """A rock mass: domain, rock, joints, waves, loads and receivers."""

    domain: Domain
    rock: IntactRock
    regions: list[Region] = []
    joint_sets: list[JointSet] = []
    waves: list[Wave] = []
    loads: list[PlaneLoad] = []
    boundaries: Boundaries = Boundaries()
    damping: Damping = Damping()
    gravity: GravityOfRock | None = None
    prestress: InSituStress | None = None
    time: Time
    numerics: NumericsOfRock = NumericsOfRock()
    record: RecordOfRock
    #: bounds on the relative L2 misfit of pairs, that of the worst waveform. `a ~ b: velocity`: of
    #: the worst of one quantity of the results; `a ~ b: PPV`, `a ~ b: peak stress`: on the relative
    #: difference of peaks, at the receiver where it is largest
    expect: dict[Pair, Positive] = {}
    name: str = ""  #: of the variant; empty for the base scene

    kind: ClassVar[str] = "rock mass"
    is_column: ClassVar[Literal[False]] = False
    law_tables: ClassVar[tuple[str, ...]] = ("joint_sets",)
    source_tables: ClassVar[tuple[str, ...]] = ("waves", "loads")
    side_table: ClassVar[str] = "boundaries"
    rotation: ClassVar[str] = "small"

    @property
    def in_space(self) -> bool:
        """Whether the scene is one in space, not in the plane."""
        return self.domain.dimension == 3

    @property
    def in_plane(self) -> bool:
        """Whether the scene is one in the plane."""
        return self.domain.dimension == 2

    @property
    def mesh_path(self) -> Path | None:
        """The file of the rock's cells or blocks, None where they are built."""
        return self.domain.mesh_path

    @property
    def reach(self) -> float:
        """The largest distance in it, m."""
        return float(np.linalg.norm(self.domain.extent))

    @property
    def excavated(self) -> bool:
        """Whether openings have been excavated in rock under a prestress: the scene then starts
        from the state that this leaves."""
        return self.prestress is not None and bool(self.domain.holes)
