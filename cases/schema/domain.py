"""The domain of a rock mass in the plane, and how it is cut into blocks."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from cases.schema.values import Point, Positive, Table, contradiction


class Domain(Table):
    """The plane region that holds the rock mass, in plane strain: x to the right, y upwards."""

    #: m, width and height of a rectangle with its lower left corner at the origin
    size: Annotated[list[Positive], Field(min_length=2, max_length=2)] | None = None
    outline: list[Point] | None = None  #: m, corners of a polygon instead
    #: m, corners of polygons that are taken out
    openings: list[list[Point]] = Field(default_factory=list)
    #: blocks at openings that are not convex; cut: in convex parts, along the faces of the opening
    non_convex: Literal["refuse", "cut"] = "refuse"
    #: blocks thinner or more pointed than below; merge: with a neighbour, where that is convex
    slivers: Literal["merge", "refuse"] = "merge"
    least_width: Positive | None = None  #: m, of a block; default a hundredth of the least spacing
    least_angle: Annotated[float, Field(ge=0, le=30)] = 1.0  #: degrees, in a block

    @model_validator(mode="after")
    def _one_shape(self) -> "Domain":
        if (self.size is None) == (self.outline is None):
            raise contradiction(
                "domain", None, "give exactly one of domain.size and domain.outline"
            )
        return self

    @property
    def corners(self) -> list[list[float]]:
        """Corners of the domain, m, without its openings."""
        if self.outline is not None:
            return self.outline
        assert self.size is not None
        x, y = self.size
        return [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]
