"""Pulses (time histories) and the loads that follow them: the load of a pillar, plane waves,
pressures, forces and shaken bases."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from jointwave.cases.schema.values import (
    Direction,
    NonNegative,
    Number,
    Offset,
    Point,
    Positive,
    Table,
    Two,
    UnitVector,
    check_dimension,
    check_keys,
    contradiction,
    dimension,
    named_file,
)

if TYPE_CHECKING:
    from jointwave.cases.histories import Recorded

Side = Literal["left", "right", "front", "back", "bottom", "top", "outline"]

#: Required and optional keys of each shape.
KEYS_OF_SHAPES: dict[str, tuple[set[str], set[str]]] = {
    "sine": ({"period"}, {"cycles"}),
    "half-sine": ({"period"}, set()),
    "ricker": ({"period"}, set()),
    "gabor": ({"period", "cycles"}, set()),
    "triangle": ({"rise", "decay"}, set()),
    "step": (set(), set()),
    "table": ({"file"}, set()),
}
#: Required and optional keys of each kind of load, in addition to its pulse.
KEYS_OF_LOADS: dict[str, tuple[set[str], set[str]]] = {
    "pressure": (set(), {"side", "opening", "between"}),
    "force": ({"at", "direction"}, set()),
    "base": ({"side", "direction"}, set()),
}
LEAST_ACROSS = 1e-9  #: least 1 - |cosine| between the direction of a wave and its polarisation
QUANTITIES = {"pressure": {"stress"}, "force": {"force"}, "base": {"velocity", "acceleration"}}


class Pulse(Table):
    """A time history and its amplitude."""

    #: half-sine: half a period; ricker: peak at 1.5 periods; gabor: a cosine in a Gaussian, peak at
    #: 1.6 `cycles`; triangle: a blast; table: linear interpolation of the samples of a file
    shape: Literal["sine", "half-sine", "ricker", "gabor", "triangle", "step", "table"]
    amplitude: Number  #: Pa, m/s or m/s2 by `quantity`; a factor on the history for "table"
    #: stress: on the start; a quiet or matched start absorbs half; incident-stress: of the wave
    #: that enters such a start, applied as twice this stress; velocity, acceleration: of the base
    #: under a fixed start, or of the wave that enters a quiet start, applied as the stress 2 rho c
    #: times its velocity
    quantity: Literal["stress", "incident-stress", "velocity", "acceleration"] = "stress"
    period: Positive | None = None  #: s; for sine, half-sine, ricker and gabor
    #: sine: default 1; gabor: cycles within two standard deviations of the envelope
    cycles: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    rise: NonNegative | None = None  #: s, rise time of a triangle
    decay: Positive | None = None  #: s, decay time of a triangle
    #: for "table": a table of two columns, s and Pa (or m/s, m/s2) where no header gives units; or
    #: a seismogram of one trace
    file: str | None = None

    file_key: ClassVar[str] = "load.file"
    _history: "Recorded | None" = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _keys_of_shape(self) -> "Pulse":
        check_keys(self, "shape", KEYS_OF_SHAPES)
        return self

    @model_validator(mode="after")
    def _read_history(self, info: ValidationInfo) -> "Pulse":
        if self.file is not None:
            from jointwave.cases.records import read_history  # slow to import

            path = named_file(info, self.file_key, self.file)
            try:
                self._history = read_history(path, self.quantity, dimension(info) == 3)
            except ValueError as error:
                raise contradiction(".file", self.file, str(error)) from None
        return self

    @property
    def history(self) -> "Recorded | None":
        """The recorded history of shape "table", else None."""
        return self._history

    @property
    def is_motion(self) -> bool:
        """Whether a load is the motion of a base rather than a stress."""
        return self.quantity in ("velocity", "acceleration")

    @property
    def time_scale(self) -> float | None:
        """The period, s; a triangle counts as half a sine period; None for a step or record."""
        if self.rise is not None and self.decay is not None:
            return 2 * (self.rise + self.decay)
        return self.period


def shortest_period(pulses: Iterable[Pulse]) -> float | None:
    """Return the shortest time scale of pulses, s; None without any."""
    return min((one.time_scale for one in pulses if one.time_scale), default=None)


class Load(Pulse):
    """The load on the start: the end stress F/A, the prescribed motion of a fixed start, or a wave
    that enters a quiet start from the rock behind it.

    The force acts along `direction` on the start face, `at` (x, z) from its centre; with `arm` it
    is a pure couple A p arm about `direction` instead.
    """

    kind: ClassVar[str] = "load"
    side: ClassVar[str] = "start"  #: that it acts on
    direction: Direction = Field(default=[0, 1, 0])  #: x, y, z
    at: Offset = Field(default=[0.0, 0.0])  #: m, x and z from the centre
    arm: Positive | None = None  #: m, of a couple

    @model_validator(mode="after")
    def _one_lever(self) -> "Load":
        if self.arm is not None and self.is_eccentric:
            raise contradiction("load.arm", self.arm, "is for a couple, which takes no load.at")
        for key, value in (("at", self.at), ("arm", self.arm)) if self.is_motion else ():
            if self.gives(key):
                allowed = f"has no meaning for load.quantity '{self.quantity}'"
                raise contradiction(f"load.{key}", value, allowed)
        return self

    @property
    def is_eccentric(self) -> bool:
        """Whether the force acts off the centre of the face."""
        return any(self.at)

    @property
    def is_across(self) -> bool:
        """Whether the load has a component across the axis."""
        return bool(self.direction[0] or self.direction[2])


#: The load of a scene without [load].
NO_LOAD = Load(shape="step", amplitude=0.0)


class Wave(Pulse):
    """A plane incident wave, which enters through the quiet sides."""

    file_key: ClassVar[str] = "waves.file"

    amplitude: Number  #: Pa or m/s by `quantity`; a factor on the history for "table"
    #: stress: on the wave front, compression positive for P; velocity: of the particles
    quantity: Literal["stress", "velocity"] = "stress"  # type: ignore[assignment]
    #: P: particles move along the direction; S: to its left, in space along `polarisation`; SV: S,
    #: in space polarised in the vertical plane of its direction
    kind: Literal["P", "S", "SV"]
    direction: UnitVector  #: x, y, in space x, y, z: of propagation
    #: x, y, z: of particle motion of an S wave in space; its part normal to the direction counts
    polarisation: UnitVector | None = None
    #: m, where the pulse begins at t = 0; absent: the first corner of the domain that it reaches
    through: Point | None = None

    @model_validator(mode="before")
    @classmethod
    def _in_the_vertical_plane(cls, table: Any, info: ValidationInfo) -> Any:
        if not isinstance(table, dict) or table.get("kind") != "SV":
            return table
        if table.get("polarisation") is not None:
            allowed = 'is of kind = "S": SV is polarised in the vertical plane of its direction'
            raise contradiction(".polarisation", table["polarisation"], allowed)
        vertical = {"polarisation": [0.0, 0.0, 1.0]} if dimension(info) == 3 else {}
        return table | vertical | {"kind": "S"}

    @model_validator(mode="after")
    def _is_polarised(self, info: ValidationInfo) -> "Wave":
        in_space = check_dimension(self, info, space=("polarisation",))
        if self.kind == "P" and self.polarisation is not None:
            raise contradiction(".polarisation", self.polarisation, "is of S waves")
        if in_space and self.kind == "S":
            along = np.dot(self.polarisation or self.direction, self.direction)
            if abs(along) > 1 - LEAST_ACROSS:
                allowed = "is required for an S wave in space: not along its direction"
                allowed += "; a vertical wave is of no kind 'SV'" * (self.polarisation is not None)
                raise contradiction(".polarisation", self.polarisation, allowed)
        return self


class PlaneLoad(Pulse):
    """A pressure on an opening or a side, a force at a point, the motion of a fixed side, or
    a wave that enters a quiet side from the rock behind it."""

    file_key: ClassVar[str] = "loads.file"

    #: Pa, N/m, in space N, m/s or m/s2 by `quantity`; a factor on the history for "table"
    amplitude: Number
    #: pressure: stress; force: force; base: velocity or acceleration
    quantity: Literal["stress", "force", "velocity", "acceleration"] = "stress"  # type: ignore[assignment]
    #: base: motion of a fixed side, or of the wave that enters a quiet side, applied as the stress
    #: 2 rho c times its velocity
    kind: Literal["pressure", "force", "base"]
    side: Side | None = None  #: under a pressure, or moved as a base
    opening: Annotated[int, Field(ge=0)] | None = None  #: under a pressure, counted from 0
    #: m, in the plane two points of the boundary: the pressure acts only between them; around an
    #: opening counter-clockwise from the first to the second, unless both are on one face
    between: Annotated[list[Point], Two] | None = None
    at: Point | None = None  #: m, where a force acts; on a joint its sides share it equally
    #: x, y, in space x, y, z: of a force or of the motion of a base
    direction: UnitVector | None = None

    @model_validator(mode="after")
    def _keys_of_kind(self, info: ValidationInfo) -> "PlaneLoad":
        check_dimension(self, info, plane=("between",))
        check_keys(self, "kind", KEYS_OF_LOADS)
        if self.quantity not in QUANTITIES[self.kind]:
            allowed = " or ".join(f"'{one}'" for one in sorted(QUANTITIES[self.kind]))
            raise contradiction(".quantity", self.quantity, f"must be {allowed} here")
        if self.kind == "pressure" and (self.side is None) == (self.opening is None):
            raise contradiction(".side", self.side, "give exactly one of side and opening")
        return self
