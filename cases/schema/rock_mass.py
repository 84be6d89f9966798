"""The scene of a rock mass, in the plane or in space: a domain cut by joint sets, and its loads.

A file with a table [domain] holds one; a file with [pillar] is a `Scene`. Tables that both have
mean the same. SI units; x to the right and y upwards in plane strain, or x to the east, y to the
north and z upwards.
"""

from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from jointwave.cases.schema import tables
from jointwave.cases.schema.damping import Attenuating, Damping
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import Inclined, JointSet
from jointwave.cases.schema.pulse import PlaneLoad, Wave
from jointwave.cases.schema.scene_base import SceneBase
from jointwave.cases.schema.values import (
    Dip,
    DipDirection,
    Number,
    Pair,
    Point,
    Poisson,
    Positive,
    Table,
    UnitVector,
    Words,
    check_dimension,
    contradiction,
    dimension,
)

Held = Literal["quiet", "free", "fixed", "roller", "periodic"]


class IntactRock(Attenuating):
    """The rock between the joints, in plane strain or in space."""

    density: Positive  #: kg/m3
    intact_modulus: Positive  #: Pa, Young's modulus
    intact_poisson: Poisson = 0.25  #: of the rock between the joints


class Boundaries(tables.Sides):
    """Boundary conditions of the sides of the domain; openings are free. Rock slides freely along a
    roller side, as along a plane of symmetry, and does not move normal to it."""

    left: Held = "free"  #: side of least x
    right: Held = "free"  #: side of largest x
    front: Held = "free"  #: side of least y, in space
    back: Held = "free"  #: side of largest y, in space
    bottom: Held = "free"  #: side of least y, in space of least z
    top: Held = "free"  #: side of largest y, in space of largest z
    outline: Literal["quiet", "free", "fixed"] = "free"  #: all other sides of an outline


class GravityOfRock(tables.Gravity):
    """A body force. Fixed and roller sides bear the weight; quiet sides do too, with the static
    reaction of a held side beside their dashpots: below the rock (within 45 degrees) in all
    directions, beside it along their normal. A quiet side above the rock bears the in-situ stress
    only."""

    direction: UnitVector = Field(default=[0.0, -1.0])  #: x, y, in space x, y, z and [0, 0, -1]

    @model_validator(mode="before")
    @classmethod
    def _downwards(cls, table: Any, info: ValidationInfo) -> Any:
        absent = isinstance(table, dict) and "direction" not in table
        return table | {"direction": [0.0, 0.0, -1.0]} if absent and dimension(info) == 3 else table


class InSituStress(Table):
    """In-situ stress of the rock mass, uniform before openings are excavated: free and quiet sides
    bear it, the walls of openings are free."""

    xx: Number  #: Pa, compression positive
    yy: Number  #: Pa, compression positive
    xy: Number = 0.0  #: Pa, component of the same tensor
    zz: Number | None = None  #: Pa, in space, where it is required
    yz: Number = 0.0  #: Pa, in space
    xz: Number = 0.0  #: Pa, in space

    @model_validator(mode="after")
    def _fits_dimension(self, info: ValidationInfo) -> "InSituStress":
        if check_dimension(self, info, space=("zz", "yz", "xz")) and self.zz is None:
            raise contradiction(".zz", None, "is required in space")
        return self

    @property
    def tensor(self) -> np.ndarray:
        """The stress [d, d], Pa."""
        rows = ("xx", "xy", "xz"), ("xy", "yy", "yz"), ("xz", "yz", "zz")
        dim = 2 if self.zz is None else 3
        return np.array([[getattr(self, key) for key in row[:dim]] for row in rows[:dim]])

    @property
    def words(self) -> str:
        """The stress as text."""
        keys = ("xx", "yy", "xy") if self.zz is None else ("xx", "yy", "zz", "xy", "yz", "xz")
        return ", ".join(f"{key} {getattr(self, key):.4g}" for key in keys) + " Pa"

    def largest(self, excavated: bool) -> float:
        """Return the largest principal stress s1, at least zero, Pa; if excavated 3 s1 - s2 with
        the least one s2, as at the wall of a circular opening (Kirsch); other openings can exceed
        it at corners."""
        low, *_, high = np.linalg.eigvalsh(self.tensor)
        return max(0.0, float(3 * high - low if excavated else high))


class RecordOfRock(tables.Recording):
    """The results that are recorded."""

    #: m, where velocity, displacement and stress are recorded; on a joint the mean of both sides
    points: list[Point] = Field(default_factory=list)
    #: m, points near joints: traction, gap and slip of the nearest joint
    joints: list[Point] = Field(default_factory=list)


class DemOfRock(tables.BlockStepping):
    """Time stepping of rigid blocks, and their size where intact rock is subdivided."""

    #: m, approximate block size: rock between joints is subdivided by joints of its own stiffness;
    #: absent: blocks are cut by the joint sets only; rock no wider than this is not cut, but layers
    #: of a fifth of this size or more within wider rock
    block: Positive | None = None


class ContinuumOfRock(tables.ElementStepping):
    """Discretisation and time stepping of the deformable rock."""

    #: in the plane; absent: quadrilaterals where every block has four corners
    cell: Literal["quadrilateral", "triangle"] | None = None
    size: Positive | None = None  #: m, element size; absent: from the shortest wave

    @model_validator(mode="after")
    def _fits_dimension(self, info: ValidationInfo) -> "ContinuumOfRock":
        check_dimension(self, info, plane=("cell",))
        return self


class NumericsOfRock(tables.Numerics):
    """Numerical parameters; the defaults are chosen for accuracy."""

    dem: DemOfRock = DemOfRock()  # type: ignore[assignment]
    continuum: ContinuumOfRock = ContinuumOfRock()  # type: ignore[assignment]


#: Name of the rock outside all regions, for joint sets.
REST = "rock"


class Region(Inclined):
    """Rock above a line or within an outline, in space above a plane, unless a later region covers
    it; absent keys are taken from [rock]. Its boundary is welded except where a joint lies along
    it."""

    name: Words  #: used in joint_sets.regions, tables and figures
    #: degrees from the horizontal; of a line counter-clockwise, "above" is to its left
    dip: Dip = 0.0
    #: of the line of dip of a plane, degrees clockwise from north (y); "above" a vertical one is
    #: where it points
    dip_direction: DipDirection | None = None
    through: Point | None = None  #: m, a point of the line or plane
    #: m, in the plane corners of a polygon instead of a line
    outline: list[list[Number]] | None = None
    density: Positive | None = None  #: kg/m3
    intact_modulus: Positive | None = None  #: Pa, Young's modulus
    intact_poisson: Poisson | None = None  #: of the rock between the joints

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> "Region":
        check_dimension(self, info, plane=("outline",))
        if (self.through is None) == (self.outline is None):
            raise contradiction(".through", self.through, "give through or outline, not both")
        if self.outline is not None and self.dip:
            raise contradiction(".dip", self.dip, "has no meaning with an outline")
        if any(len(corner) != 2 for corner in self.outline or ()):
            raise contradiction(".outline", self.outline, "must have 2 numbers a corner")
        return self

    def rock(self, rest: IntactRock) -> IntactRock:
        """Return the region's rock; absent keys come from the rest."""
        own = {key: getattr(self, key, None) for key in IntactRock.model_fields}
        return rest.model_copy(update={k: v for k, v in own.items() if v is not None})


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
    time: tables.Time
    numerics: NumericsOfRock = NumericsOfRock()
    record: RecordOfRock
    #: largest relative L2 misfit of each pair of solvers, over all waveforms; `a ~ b: velocity`:
    #: over those of one quantity; `a ~ b: PPV`, `a ~ b: peak stress`: largest relative difference
    #: of peaks, over all receivers
    expect: dict[Pair, Positive] = {}
    name: str = ""  #: of the variant; empty for the base scene

    kind: ClassVar[str] = "rock mass"
    is_column: ClassVar[Literal[False]] = False
    law_tables: ClassVar[tuple[str, ...]] = ("joint_sets",)
    source_tables: ClassVar[tuple[str, ...]] = ("waves", "loads")
    side_table: ClassVar[str] = "boundaries"
    rotation: ClassVar[str] = "small"
    soft_layers: ClassVar[tuple[()]] = ()
    off_axis: ClassVar[str] = "a rock mass has no axis"

    @property
    def axes(self) -> str:
        """The axes of the domain."""
        return "xyz"[: self.domain.dimension]

    @property
    def mesh_path(self) -> Path | None:
        """The file of the rock's cells or blocks; None if they are built."""
        return self.domain.mesh_path

    @property
    def reach(self) -> float:
        """The diagonal of the domain's bounding box, m."""
        return float(np.linalg.norm(self.domain.extent))

    def left_out(self, dim: int) -> float:
        """Return 1: a model in the plane is per metre of thickness."""
        return 1.0

    @property
    def excavated(self) -> bool:
        """Whether openings are excavated in prestressed rock; the scene starts from the result."""
        return self.prestress is not None and bool(self.domain.holes)
