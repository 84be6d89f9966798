"""The small tables of a scene: pillar, rock, ends, initial state, receivers, numerics."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from jointwave.cases.schema.damping import Attenuating
from jointwave.cases.schema.values import (
    Direction,
    NonNegative,
    Number,
    Poisson,
    Positive,
    Table,
    contradiction,
    named_file,
)

SPEEDS = ("p_speed", "s_speed")
CONSTANTS = ("equivalent_modulus", "equivalent_poisson")
PAIRS = " and ".join(SPEEDS) + ", or " + " and ".join(CONSTANTS)

LEAN = 0.5**0.5 - 1e-9  # cosine of 45 degrees: a side within this angle of gravity bears weight

MOST_BLOCKS = 10_000_000  # about 0.4 kB per block: the memory of one machine


class Pillar(Table):
    """A square rock pillar cut by joints into one row of equal blocks (section 3.1)."""

    length: Positive  #: m
    side: Positive  #: m, side of the square section
    #: m, block thickness d = joint spacing S; with `joints`: at most, or absent
    block: Positive
    #: m, places of joints of `joints.normal_stiffness` in intact rock, instead of one at every
    #: `block`; read as `segments` without joints and `soft_layers`. Blocks between them are equal;
    #: absent `block`: 40 blocks per wavelength of the load's highest frequency
    joints: list[Positive] | None = None

    @model_validator(mode="after")
    def _whole_blocks(self) -> "Pillar":
        count = self.length / self.block
        if not 1.5 < count <= MOST_BLOCKS:
            allowed = f"must give 2 to {MOST_BLOCKS:,} blocks, not {count:g}"
            raise contradiction("pillar.block", self.block, allowed)
        if abs(count - round(count)) > 1e-9 * count:
            allowed = f"must divide pillar.length = {self.length:g} into a whole number of blocks"
            raise contradiction("pillar.block", self.block, allowed)
        return self

    @property
    def block_count(self) -> int:
        """Number of blocks N = length / block."""
        return round(self.length / self.block)

    @property
    def area(self) -> float:
        """Section area A, m2."""
        return self.side**2


class Rock(Attenuating):
    """The rock mass by its two wave speeds, by its two elastic constants, or by the intact rock and
    `joints.normal_stiffness`."""

    density: Positive  #: kg/m3
    p_speed: Positive | None = None  #: m/s, unbounded rock mass
    s_speed: Positive | None = None  #: m/s
    equivalent_modulus: Positive | None = None  #: Pa, E_eq of the rock mass
    #: of the rock mass; absent, with `joints.normal_stiffness`: intact_poisson
    equivalent_poisson: Poisson | None = None
    intact_modulus: Positive | None = None  #: Pa, E of the blocks; for the jointed continuum
    intact_poisson: Poisson = 0.25  #: of the blocks

    @model_validator(mode="after")
    def _one_pair(self) -> "Rock":
        speeds, constants = given_pairs(self)
        if (speeds and constants) or len(speeds) == 1 or constants == [CONSTANTS[0]]:
            raise contradiction("rock", speeds + constants, f"give exactly one pair: {PAIRS}")
        if wrong := wrong_speeds(self):
            raise contradiction("rock.p_speed", self.p_speed, wrong)
        return self


def check_given_once(table: str, rock: Any, stiffness: str, law: Any) -> None:
    """Refuse a joint stiffness together with the constants of the rock mass that it sets.

    table, stiffness : the tables that hold them, for messages.
    """
    for key, twice in (
        ("normal_stiffness", [*SPEEDS, CONSTANTS[0]]),
        ("shear_stiffness", [*SPEEDS]),
    ):
        given = [f"{table}.{one}" for one in twice if getattr(rock, one) is not None]
        if given and (value := getattr(law, key, None)) is not None:
            allowed = (
                f"decides what {' and '.join(given)} would decide: leave out "
                f"{'these' if len(given) > 1 else 'this'}, or the joints' {key}"
            )
            raise contradiction(f"{stiffness}.{key}", value, allowed)


def given_pairs(table: Table) -> list[list[str]]:
    """Return the speeds and the elastic constants of the rock mass that a table gives."""
    return [[k for k in pair if getattr(table, k) is not None] for pair in (SPEEDS, CONSTANTS)]


def wrong_speeds(table: Any) -> str | None:
    """Return why a table's p_speed and s_speed are inconsistent; None if they are not."""
    if table.p_speed and table.s_speed and table.p_speed**2 <= 4 / 3 * table.s_speed**2:
        return f"must exceed sqrt(4/3) times s_speed = {table.s_speed:g} (positive bulk modulus)"
    return None


class Scatter(Table):
    """Random joints, uniformly distributed about their means; intact segments have none."""

    #: coefficient of variation of the block thickness; segments keep their lengths
    spacing: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    #: coefficient of variation of the joints' compliance 1/K_n, whose mean is unchanged
    compliance: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    seed: Annotated[int, Field(ge=0, lt=2**63)]  #: the same seed gives the same joints

    @model_validator(mode="after")
    def _scatters(self) -> "Scatter":
        if not self.spacing and not self.compliance:
            raise contradiction("scatter", None, "give scatter.spacing, compliance or both")
        return self


class Motion(Table):
    """Rotation of the blocks in scenes with motion across the axis."""

    #: none: translation only, plane sections with free sides (E along the pillar, G across it);
    #: small: rotation vectors; finite: quaternions
    rotation: Literal["none", "small", "finite"] = "small"


class Sides(Table):
    """Boundary conditions of sides, by their names."""

    def sides(self, *kinds: str) -> list[str]:
        """Return the sides with one of these conditions."""
        return [side for side, held in self if held in kinds]


class Ends(Sides):
    """Boundary conditions of the ends: matched, a dashpot behind the end block's half-block spring,
    reflects least; quiet, (9), has the dashpot on the end block; fixed is a wall that the rock
    joins without a joint.
    """

    start: Literal["free", "quiet", "matched", "fixed"] = "free"  #: at y = 0
    end: Literal["free", "quiet", "matched", "fixed"] = "free"  #: at y = length


class Gravity(Table):
    """A body force. Fixed ends bear the weight; quiet and matched ends do too, with the static
    reaction of a fixed end beside their dashpots, unless gravity pulls the pillar off them."""

    direction: Direction  #: x, y, z
    acceleration: NonNegative = 9.81  #: m/s2
    static: bool = True  #: the scene starts in equilibrium; False: gravity acts suddenly at t = 0


class Prestress(Table):
    """Initial normal stress of the joints, also carried by ends that are not fixed."""

    normal: Number  #: Pa, compression positive

    @property
    def tensor(self) -> np.ndarray:
        """The stress [3, 3], Pa."""
        return np.diag([0.0, self.normal, 0.0])

    @property
    def words(self) -> str:
        """The stress as text."""
        return f"{self.normal:.4g} Pa"

    def largest(self, excavated: bool) -> float:
        """Return the magnitude of the stress, Pa."""
        return abs(self.normal)


class Time(Table):
    """Duration of the scene."""

    duration: Positive  #: s


class Recording(Table):
    """Sampling interval, snapshots and energy ledger."""

    interval: Positive | None = None  #: s; default: period / 200, or duration / 2000
    fields: Positive | None = None  #: s between snapshots of the whole body; absent: none
    energy: bool = True  #: record the energy ledger


class Record(Recording):
    """The results that are recorded."""

    stress: list[NonNegative] = Field(default_factory=list)  #: m, sections
    #: m, points of velocity and displacement; on a joint the mean of both sides
    velocity: list[NonNegative] = Field(default_factory=list)


class BlockStepping(Table):
    """Time stepping of rigid blocks."""

    step_fraction: Positive = 0.2  #: of the critical step
    allow_unstable: bool = False  #: allow a step above the critical one
    #: out-of-balance force ratio of the static state; absent: smaller where loads are small
    static_tolerance: Positive = 1e-8
    threads: Annotated[int, Field(ge=1, le=1024)] | None = None  #: absent: by the number of blocks


class DemNumerics(BlockStepping):
    """Time stepping of the rigid blocks; the default step is for accuracy, not only stability."""

    step_fraction: Positive = 0.05  #: of the scheme's own critical step
    #: fourth-order (PEFRL): four force evaluations per step, for axial motion without damping
    scheme: Literal["leapfrog", "fourth-order"] = "leapfrog"


class ElementStepping(Table):
    """Order of the elements of the deformable rock, and its time stepping."""

    order: Annotated[int, Field(ge=1, le=4)] = 2  #: at most 2 for triangles, tetrahedra
    scheme: Literal["auto", "explicit", "implicit"] = "auto"  #: auto: whichever costs less
    step_fraction: Positive = 0.5  #: explicit: of the critical step
    steps_per_period: Positive = 200  #: implicit: of the shortest pulse, or a tenth of the duration
    spectral_radius: Annotated[float, Field(ge=0, le=1)] = 0.9  #: implicit: at infinite frequency
    allow_unstable: bool = False  #: allow an explicit step above the critical one


class ContinuumNumerics(ElementStepping):
    """Discretisation and time stepping of the deformable rock."""

    step_fraction: Positive = 0.2  #: explicit: of the critical step
    #: 1: bar; 2: plane stress; 3: square column; absent: the least that the scene needs
    dim: Annotated[int, Field(ge=1, le=3)] | None = None
    cell: Literal["hexahedron", "simplex"] = "hexahedron"  #: quadrilateral and triangle in dim 2
    #: absent: a wave crosses one in 1/100 of the shortest period at most, 1/25 in damped rock
    elements_per_block: Annotated[int, Field(ge=1, le=1000)] | None = None
    elements_across: Annotated[int, Field(ge=1, le=100)] = 1  #: in each direction of the section
    mesh: str | None = None  #: a gmsh file (.msh) of the pillar, with its rock and joints tagged

    _mesh_path: Path | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _find_mesh(self, info: ValidationInfo) -> "ContinuumNumerics":
        if self.mesh is not None:
            self._mesh_path = named_file(info, "numerics.continuum.mesh", self.mesh)
        return self

    @property
    def mesh_path(self) -> Path | None:
        """The file `mesh`, relative to the scene's folder; None if the mesh is built."""
        return self._mesh_path


class Numerics(Table):
    """Numerical parameters; the defaults are chosen for accuracy."""

    #: joints may move by more than 2 % of a block; else such a run stops. Contacts stay those of
    #: the start, even where blocks would touch new neighbours
    allow_large_motion: bool = False
    dem: DemNumerics = DemNumerics()
    continuum: ContinuumNumerics = ContinuumNumerics()
