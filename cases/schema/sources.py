"""Sources in rock: plane waves, pressures, forces and a shaken base."""

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.values import (
    Number,
    Point,
    Two,
    UnitVector,
    check_dimension,
    check_keys,
    contradiction,
    dimension,
)

Side = Literal["left", "right", "front", "back", "bottom", "top", "outline"]

#: Required and optional keys of each kind of load, in addition to its pulse.
KEYS: dict[str, tuple[set[str], set[str]]] = {
    "pressure": (set(), {"side", "opening", "between"}),
    "force": ({"at", "direction"}, set()),
    "base": ({"side", "direction"}, set()),
}
LEAST_ACROSS = 1e-9  #: one less the cosine between the direction of a wave and its polarisation
QUANTITIES = {"pressure": {"stress"}, "force": {"force"}, "base": {"velocity", "acceleration"}}


class Wave(Pulse):
    """A plane incident wave, which enters through the quiet sides."""

    file_key: ClassVar[str] = "waves.file"

    amplitude: Number  #: Pa or m/s by `quantity`; a factor on the history for "table"
    #: stress: on the wave front, compression positive for P; velocity: of the particles
    quantity: Literal["stress", "velocity"] = "stress"  # type: ignore[assignment]
    #: P: particles move along the direction; S: normal to it, to its left, in space as
    #: `polarisation`; SV: S, in space polarised in the vertical plane of its direction
    kind: Literal["P", "S", "SV"]
    direction: UnitVector  #: x, y, in space x, y, z: of propagation
    #: x, y, z: of particle motion of an S wave in space, of which the part across the direction
    #: counts
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
    side: Side | None = None  #: loaded by a pressure, or moved as a base
    opening: Annotated[int, Field(ge=0)] | None = None  #: loaded by a pressure, counted from 0
    #: m, in the plane two points of the boundary: the pressure acts only between them; around an
    #: opening counter-clockwise from the first to the second, unless both are on one face
    between: Annotated[list[Point], Two] | None = None
    at: Point | None = None  #: m, where a force acts; on a joint on its sides alike
    #: x, y, in space x, y, z: of a force or of the motion of a base
    direction: UnitVector | None = None

    @model_validator(mode="after")
    def _keys_of_kind(self, info: ValidationInfo) -> "PlaneLoad":
        check_dimension(self, info, plane=("between",))
        check_keys(self, "kind", KEYS)
        if self.quantity not in QUANTITIES[self.kind]:
            allowed = " or ".join(f"'{one}'" for one in sorted(QUANTITIES[self.kind]))
            raise contradiction(".quantity", self.quantity, f"must be {allowed} here")
        if self.kind == "pressure" and (self.side is None) == (self.opening is None):
            raise contradiction(".side", self.side, "give exactly one of side and opening")
        return self
