"""The small tables of a rock mass: its intact rock, its sides, what fills it, what is recorded."""

from typing import Annotated, Literal

from pydantic import Field

from cases.schema.damping import Attenuating
from cases.schema.values import (
    DirectionInPlane,
    NonNegative,
    Number,
    Point,
    Poisson,
    Positive,
    Table,
)

Held = Literal["quiet", "free", "fixed", "periodic"]


class IntactRock(Attenuating):
    """The rock between the joints, in plane strain."""

    density: Positive  #: kg/m3
    intact_modulus: Positive  #: Pa, Young's modulus
    intact_poisson: Poisson = 0.25  #: of the rock between the joints


class Boundaries(Table):
    """What holds the sides of the domain; those of openings are free."""

    left: Held = "free"  #: where the domain is bounded by its least x
    right: Held = "free"  #: by its largest x
    bottom: Held = "free"  #: by its least y
    top: Held = "free"  #: by its largest y
    outline: Literal["quiet", "free", "fixed"] = "free"  #: everywhere else


class GravityInPlane(Table):
    """A body force."""

    direction: DirectionInPlane = Field(default=[0.0, -1.0])  #: x, y
    acceleration: NonNegative = 9.81  #: m/s2
    static: bool = True  #: the scene starts in equilibrium; False: gravity acts suddenly at t = 0


class StressInPlane(Table):
    """Stress that the rock mass carries before anything acts, the same everywhere."""

    xx: Number  #: Pa, compression positive
    yy: Number  #: Pa, compression positive
    xy: Number = 0.0  #: Pa, with the sign that makes it part of the same tensor


class RecordInPlane(Table):
    """What is kept of a run."""

    points: list[Point] = Field(default_factory=list)  #: m, where the motion is recorded
    #: m, points beside joints: tractions, gap and slip of the nearest one
    joints: list[Point] = Field(default_factory=list)
    interval: Positive | None = None  #: s; default a 200th of the period, or duration / 2000
    fields: Positive | None = None  #: s between snapshots of the whole domain; absent: none
    energy: bool = True  #: keep the energy ledger


class DemInPlane(Table):
    """How rigid blocks are stepped, and whether intact rock between joints is cut, too."""

    #: m: blocks of about this size between the joints, by further joints as stiff as the rock that
    #: they stand for; absent: the joint sets alone make the blocks
    block: Positive | None = None
    step_fraction: Positive = 0.2  #: of the critical step
    allow_unstable: bool = False  #: go on with a step above the critical one
    static_tolerance: Positive = 1e-8  #: out-of-balance force ratio that ends the static state
    threads: Annotated[int, Field(ge=1, le=1024)] | None = None  #: absent: by the number of blocks


class ContinuumInPlane(Table):
    """How the deformable rock is discretised and stepped."""

    order: Annotated[int, Field(ge=1, le=4)] = 2  #: of the elements; at most 2 for triangles
    #: absent: quadrilaterals where every block has four corners
    cell: Literal["quadrilateral", "triangle"] | None = None
    size: Positive | None = None  #: m, of the elements; absent: by the shortest wave
    scheme: Literal["auto", "explicit", "implicit"] = "auto"  #: auto: whichever costs less
    step_fraction: Positive = 0.5  #: of the critical step, explicit
    steps_per_period: Positive = 200  #: implicit; of the shortest pulse, or a tenth of the duration
    spectral_radius: Annotated[float, Field(ge=0, le=1)] = 0.9  #: implicit, of infinite frequency
    allow_unstable: bool = False  #: go on with an explicit step above the critical one


class NumericsInPlane(Table):
    """How, not what: every key has a default that is chosen for accuracy."""

    dem: DemInPlane = DemInPlane()
    continuum: ContinuumInPlane = ContinuumInPlane()
