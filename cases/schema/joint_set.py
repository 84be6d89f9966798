"""Keys of a joint set of a rock mass."""

from typing import Annotated

from pydantic import Field

from cases.schema.joint import Joints
from cases.schema.values import Point, Positive, Words


class JointSet(Joints):
    """Parallel joints, or one joint, with the law of them all."""

    name: Words  #: what [[joint_sets]] that end here, tables and figures call it
    #: degrees from the horizontal, counter-clockwise; the joints run along (cos, sin) of it
    dip: Annotated[float, Field(ge=-180, le=180)]
    spacing: Positive | None = None  #: m, across the joints; absent: one joint, `through` a point
    through: Point | None = None  #: m, a point of one of the joints; absent: the origin
    ends_at: list[str] = Field(default_factory=list)  #: names of sets whose joints these end at
    #: names of [[regions]] whose rock it cuts, "rock" for what no region holds; absent: all
    regions: list[str] = Field(default_factory=list)
    #: of the spacing, along the joints that they end at, from each to the next; 0.5: brickwork
    offset: Annotated[float, Field(ge=0, lt=1)] = 0.0
    #: standard deviation of the spacing over its mean; uniformly distributed
    scatter: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None  #: of the scatter
