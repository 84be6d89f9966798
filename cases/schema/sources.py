"""Sources in the plane: plane waves, pressures, forces and a shaken base."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.values import DirectionInPlane, Number, Point, contradiction_here

Side = Literal["left", "right", "bottom", "top", "outline"]

#: Required and optional keys of each kind of load, in addition to its pulse.
KEYS = {
    "pressure": (set(), {"side", "opening", "between"}),
    "force": ({"at", "direction"}, set()),
    "base": ({"side", "direction"}, set()),
}
QUANTITIES = {"pressure": {"stress"}, "force": {"force"}, "base": {"velocity", "acceleration"}}


class Wave(Pulse):
    """A plane incident wave, which enters through the quiet sides."""

    file_key: ClassVar[str] = "waves.file"

    amplitude: Number  #: Pa or m/s by `quantity`; a factor on the history for "table"
    #: stress: on the wave front, compression positive for P; velocity: of the particles
    quantity: Literal["stress", "velocity"] = "stress"  # type: ignore[assignment]
    #: P: particles move along the direction; S: normal to it, to its left
    kind: Literal["P", "S"]
    direction: DirectionInPlane  #: x, y: of propagation
    #: m, where the pulse begins at t = 0; absent: the first corner of the domain that it reaches
    through: Point | None = None


class PlaneLoad(Pulse):
    """A pressure on an opening or a side, a force at a point, the motion of a fixed side, or
    a wave that enters a quiet side from the rock behind it."""

    file_key: ClassVar[str] = "loads.file"

    amplitude: Number  #: Pa, N/m, m/s or m/s2 by `quantity`; a factor on the history for "table"
    #: pressure: stress; force: force; base: velocity or acceleration
    quantity: Literal["stress", "force", "velocity", "acceleration"] = "stress"  # type: ignore[assignment]
    #: base: motion of a fixed side, or of the wave that enters a quiet side, applied as the stress
    #: 2 rho c times its velocity
    kind: Literal["pressure", "force", "base"]
    side: Side | None = None  #: loaded by a pressure, or moved as a base
    opening: Annotated[int, Field(ge=0)] | None = None  #: loaded by a pressure, counted from 0
    #: m, two points of the boundary: the pressure acts only between them; around an opening
    #: counter-clockwise from the first to the second, unless both are on one face
    between: Annotated[list[Point], Field(min_length=2, max_length=2)] | None = None
    at: Point | None = None  #: m, where a force acts
    direction: DirectionInPlane | None = None  #: x, y: of a force or of the motion of a base

    @model_validator(mode="after")
    def _keys_of_kind(self) -> "PlaneLoad":
        needed, taken = KEYS[self.kind]
        for key in ("side", "opening", "between", "at", "direction"):
            value = getattr(self, key)
            if key in needed and value is None:
                raise contradiction_here(key, None, f"is needed for {{table}}.kind = '{self.kind}'")
            if value is not None and key not in needed | taken:
                raise contradiction_here(key, value, f"has no meaning for kind '{self.kind}'")
        if self.quantity not in QUANTITIES[self.kind]:
            allowed = " or ".join(f"'{one}'" for one in sorted(QUANTITIES[self.kind]))
            raise contradiction_here("quantity", self.quantity, f"must be {allowed} here")
        if self.kind == "pressure" and (self.side is None) == (self.opening is None):
            raise contradiction_here("side", self.side, "give exactly one of side and opening")
        return self
