"""The domain of a rock mass, and how it is cut into blocks."""

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from jointwave.cases.geometry.cell_complex import NO_SET, Complex
from jointwave.cases.schema.values import (
    Increasing,
    Number,
    Offset,
    Point,
    Positive,
    Table,
    Two,
    check_dimension,
    contradiction,
    named_file,
)


class Prism(Table):
    """An opening in space with a polygonal section: a tunnel, or a cavern with an arched roof."""

    #: m, corners, by their two coordinates other than along the axis, in the order x, y, z
    polygon: Annotated[list[Offset], Field(min_length=3)]
    axis: Literal["x", "y", "z"]  #: of the prism
    #: m, start and end along the axis; absent: all through the domain
    ends: Annotated[list[Number], Two, Increasing] | None = None


class Domain(Table):
    """The region of the rock mass: in plane strain with x to the right and y upwards, or in space
    with x to the east, y to the north and z upwards."""

    #: m, width and height of a rectangle, or width, depth and height of a box, from the origin on;
    #: three numbers make the scene one in space, and all its points and directions have three
    size: Annotated[list[Positive], Field(min_length=2, max_length=3)] | None = None
    outline: list[Point] | None = None  #: m, corners of a polygon, instead of size
    #: a gmsh file (.msh) instead: groups "rock..." of cells of one kind, and "joint NAME" of the
    #: facets of each joint set; its outline and openings are those of the rock. Tetrahedra and
    #: hexahedra make the scene one in space
    mesh: str | None = None
    #: a file of convex blocks instead, each a cell of VTU (.vtu), a surface or volume of gmsh
    #: (.msh), a mesh of COMPAS (.json) or an object of OBJ (.obj); blocks in space make the scene
    #: one in space. Contacts belong to the set of their gmsh group "joint NAME", in files without
    #: groups to the set whose planes are nearest in angle
    blocks: str | None = None
    #: m, corners of polygons to be excavated; in space two opposite corners of each box
    openings: list[list[Point]] = Field(default_factory=list)
    prisms: list[Prism] = Field(default_factory=list)
    #: for non-convex blocks at openings; cut: into convex parts along the opening's faces
    non_convex: Literal["refuse", "cut"] = "refuse"
    #: for blocks below the next two limits; merge: with a neighbour, if the result is convex
    slivers: Literal["merge", "refuse"] = "merge"
    least_width: Positive | None = None  #: m, of a block; absent: a hundredth of the least spacing
    least_angle: Annotated[float, Field(ge=0, le=30)] = 1.0  #: degrees, in a block

    _mesh_path: Path | None = PrivateAttr(default=None)
    _outlines: Any = PrivateAttr(default=None)
    _sets: list[str] | None = PrivateAttr(default=None)  # names of all joint sets
    _groups: Any = PrivateAttr(default=None)
    _body: Any = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_shape(self, info: ValidationInfo) -> "Domain":
        check_dimension(self, info, space=("prisms",))
        shapes = (self.size, self.outline, self.mesh, self.blocks)
        if sum(one is not None for one in shapes) != 1:
            allowed = "give exactly one of domain.size, domain.outline, domain.mesh, domain.blocks"
            raise contradiction("domain", None, allowed)
        if key := self.file_key:
            if self.holes:
                raise contradiction("domain.openings", None, f"are part of {key}")
            self._mesh_path = named_file(info, key, self.mesh or self.blocks or "")
            self._read(key, self._mesh_path)
            if info.context:
                info.context["dimension"] = self.dimension  # of all tables after this one
        return self

    @property
    def file_key(self) -> str | None:
        """The key that names a file of rock cells or blocks; None without."""
        if self.mesh is None and self.blocks is None:
            return None
        return "domain.blocks" if self.mesh is None else "domain.mesh"

    def _read(self, key: str, path: Path) -> None:
        from jointwave.cases.geometry import own_blocks
        from jointwave.cases.gmsh_file import MeshError

        try:
            self._body, self._groups = own_blocks.complex_of_file(path, self.mesh is not None)
            self._outlines = [one.tolist() for one in own_blocks.outlines_of(self._body)]
        except MeshError as error:
            raise contradiction(key, self.mesh or self.blocks, str(error)) from None

    def join(self, names: list[str], normals: np.ndarray) -> None:
        """Assign the contacts of a file to joint sets, once, as scenes derived from this one share
        its domain. normals : of the sets [sets, d]. Raises a contradiction."""
        from jointwave.cases.geometry.own_blocks import with_sets
        from jointwave.cases.gmsh_file import MeshError

        if self._sets is not None:
            return
        try:
            self._body = with_sets(self._body, self._groups, names, normals)
            self._sets = names
        except MeshError as error:
            assert self.file_key is not None
            raise contradiction(self.file_key, self.mesh or self.blocks, str(error)) from None

    @property
    def given(self) -> Complex | None:
        """The blocks of the file `mesh` or `blocks`; None if joint sets cut the domain."""
        return self._body

    def cells(self, names: list[str]) -> Complex:
        """Return the blocks of the file with the joints of some of the scene's sets only."""
        assert self._body is not None
        known = {name.lower(): k for k, name in enumerate(names)}
        joints = self._sets if self._sets is not None else self._groups or []
        number = np.array([*(known.get(name.lower(), NO_SET) for name in joints), NO_SET])
        return replace(self._body, joint_set=number[self._body.joint_set])

    @property
    def mesh_path(self) -> Path | None:
        """The file `mesh` or `blocks`, relative to the scene's folder."""
        return self._mesh_path

    @property
    def dimension(self) -> int:
        """The number of dimensions, 2 or 3."""
        return len(self.size) if self.size is not None else len(self.corners[0])

    @property
    def extent(self) -> np.ndarray:
        """Size along each axis, m [d]."""
        return np.ptp(self.corners, axis=0)

    @property
    def holes(self) -> list[Any]:
        """All openings: corners of polygons or boxes, m (of the file's, if given), and prisms."""
        own = [*self.openings, *self.prisms]
        return own if self.given is None else self._outlines[1:]

    @property
    def corners(self) -> list[list[float]]:
        """Corners of the domain, m, without its openings."""
        if self.given is not None:
            return self._outlines[0]
        if self.outline is not None:
            return self.outline
        assert self.size is not None
        if len(self.size) == 3:
            return [list(one) for one in product(*((0.0, x) for x in self.size))]
        x, y = self.size
        return [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]
