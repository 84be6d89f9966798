"""Regions of a rock mass: rock beyond a line or within an outline that differs from [rock]."""

from pydantic import ValidationInfo, model_validator

from jointwave.cases.schema.plane import IntactRock
from jointwave.cases.schema.values import (
    Dip,
    DipDirection,
    Point,
    Poisson,
    Positive,
    Table,
    Words,
    check_attitude,
    check_dimension,
    contradiction,
)

#: Name, for joint sets, of rock outside all regions.
REST = "rock"


class Region(Table):
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
    outline: list[Point] | None = None  #: m, in the plane corners of a polygon instead of a line
    density: Positive | None = None  #: kg/m3
    intact_modulus: Positive | None = None  #: Pa, Young's modulus
    intact_poisson: Poisson | None = None  #: of the rock between the joints

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> "Region":
        check_dimension(self, info, plane=("outline",))
        check_attitude(self, info)
        if (self.through is None) == (self.outline is None):
            raise contradiction(".through", self.through, "give through or outline, not both")
        if self.outline is not None and self.dip:
            raise contradiction(".dip", self.dip, "has no meaning with an outline")
        return self

    def rock(self, rest: IntactRock) -> IntactRock:
        """Return the region's rock, given that of the rest."""
        own = {key: getattr(self, key, None) for key in IntactRock.model_fields}
        return rest.model_copy(update={k: v for k, v in own.items() if v is not None})
