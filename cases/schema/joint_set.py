"""Keys of a joint set of a rock mass."""

from typing import Annotated

from pydantic import Field, ValidationInfo, model_validator

from jointwave.cases.schema.joint import Joints
from jointwave.cases.schema.values import (
    Dip,
    DipDirection,
    Point,
    Positive,
    Words,
    check_attitude,
)


class JointSet(Joints):
    """A set of parallel joints, or one joint, and its law."""

    name: Words  #: used in `ends_at`, tables and figures
    #: degrees from the horizontal; in the plane counter-clockwise: joints run along (cos, sin)
    dip: Dip
    #: of the line of dip, degrees clockwise from north (y); in space, unless horizontal
    dip_direction: DipDirection | None = None
    spacing: Positive | None = None  #: m, across the joints; absent: one joint, `through` a point
    through: Point | None = None  #: m, a point of one of the joints; absent: the origin
    ends_at: list[str] = Field(default_factory=list)  #: names of sets at whose joints these end
    #: names of [[regions]] that it cuts, "rock" for rock in no region; absent: all
    regions: list[str] = Field(default_factory=list)
    #: offset along the `ends_at` joints from row to row, over the spacing; 0.5: brickwork
    offset: Annotated[float, Field(ge=0, lt=1)] = 0.0
    #: coefficient of variation of the spacing; uniformly distributed
    scatter: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None  #: of the scatter

    @model_validator(mode="after")
    def _has_attitude(self, info: ValidationInfo) -> "JointSet":
        check_attitude(self, info)
        return self
