"""The domain of a rock mass in the plane, and how it is cut into blocks."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from jointwave.cases.schema.values import Point, Positive, Table, contradiction, named_file

if TYPE_CHECKING:
    from jointwave.cases.partition.given import GivenRock


class Domain(Table):
    """The region of the rock mass, in plane strain: x to the right, y upwards."""

    #: m, width and height of a rectangle with its lower left corner at the origin
    size: Annotated[list[Positive], Field(min_length=2, max_length=2)] | None = None
    outline: list[Point] | None = None  #: m, corners of a polygon, instead of size
    #: a gmsh file (.msh) instead: groups "rock..." of triangles or quadrilaterals, and "joint NAME"
    #: of the edges of each joint set; its outline and openings are those of the rock
    mesh: str | None = None
    #: m, corners of polygons to be excavated
    openings: list[list[Point]] = Field(default_factory=list)
    #: for non-convex blocks at openings; cut: into convex parts along the opening's faces
    non_convex: Literal["refuse", "cut"] = "refuse"
    #: for blocks below the next two limits; merge: with a neighbour, if the result is convex
    slivers: Literal["merge", "refuse"] = "merge"
    least_width: Positive | None = None  #: m, of a block; default a hundredth of the least spacing
    least_angle: Annotated[float, Field(ge=0, le=30)] = 1.0  #: degrees, in a block

    _mesh_path: Path | None = PrivateAttr(default=None)
    _given: Any = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> "Domain":
        if sum(one is not None for one in (self.size, self.outline, self.mesh)) != 1:
            allowed = "give exactly one of domain.size, domain.outline and domain.mesh"
            raise contradiction("domain", None, allowed)
        if self.mesh is not None:
            if self.openings:
                raise contradiction("domain.openings", None, "are part of domain.mesh")
            self._mesh_path = named_file(info, "domain.mesh", self.mesh)
            self._given = self._read()
        return self

    def _read(self) -> "GivenRock":
        from jointwave.cases.gmsh_file import MeshError
        from jointwave.cases.partition.given import read_rock

        assert self._mesh_path is not None
        try:
            return read_rock(self._mesh_path)
        except MeshError as error:
            raise contradiction("domain.mesh", self.mesh, str(error)) from None

    @property
    def given(self) -> "GivenRock | None":
        """The rock of the file `mesh`; None where joint sets cut the domain."""
        return self._given

    @property
    def mesh_path(self) -> Path | None:
        """The file `mesh`, found relative to the scene's."""
        return self._mesh_path

    @property
    def holes(self) -> list[list[list[float]]]:
        """Corners of all openings, m."""
        return self.openings if self.given is None else self.given.outlines[1:]

    @property
    def corners(self) -> list[list[float]]:
        """Corners of the domain, m, without its openings."""
        if self.given is not None:
            return self.given.outlines[0]
        if self.outline is not None:
            return self.outline
        assert self.size is not None
        x, y = self.size
        return [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]
