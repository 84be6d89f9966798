"""The small tables of a rock mass: its intact rock, its sides, what fills it, what is recorded."""

from typing import Literal

from pydantic import Field

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


class IntactRock(Table):
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
