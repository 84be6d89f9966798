"""A mesh in plain numpy: pieces of rock, and the facets on which joints or loads act."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np


class Part(NamedTuple):
    """A connected piece of rock, at one or more places; copies share no vertices.

    x : float array [vertices, dim], m: (y,), (x, y) or (x, y, z); y along the pillar.
    cells : int array [cells, corners], vertex numbers in basix's corner order (the tensor order for
        quadrilaterals and hexahedra), with positive Jacobians.
    material : int array [cells], 0 the rock, k the k-th of `Mesh.layers` counted from 1; of
        a pillar of segments the segment, of a rock mass the k-th region, from 1.
    shifts : float array [copies, dim], m, added to x.
    tied : int array [pairs, vertices]; of a vertex on one of a pair of periodic sides the vertex on
        the other that moves alike, else -1. None without.
    """

    x: np.ndarray
    cells: np.ndarray
    material: np.ndarray
    shifts: np.ndarray
    tied: np.ndarray | None = None

    @property
    def copies(self) -> int:
        """The number of copies of the part."""
        return len(self.shifts)


class Side(NamedTuple):
    """One side of some facets.

    Cells are numbered through the mesh: those of part 0 copy 0, of part 0 copy 1, ..., of part 1
    copy 0, ...

    cell : int array [facets].
    corners : float array [facets, facet corners, dim], m, in basix's order of a facet's corners.
    """

    cell: np.ndarray
    corners: np.ndarray


class Joints(NamedTuple):
    """Pairs of coincident facets that joints connect.

    joint : int array [facets], index of the joint whose law applies (in a pillar, 0 is nearest the
        loaded end), or of the contact in a rock mass.
    left, right : int arrays [facets], cell numbers as in `Side`; left is the side towards y = 0 of
        a pillar, that of the contact's block i in a rock mass.
    corners : float array [facets, facet corners, dim], m, of the left cell's facet.
    shift : float array [facets, dim], m, offset of the right cells across periodic sides; None
        without periodic sides.
    """

    joint: np.ndarray
    left: np.ndarray
    right: np.ndarray
    corners: np.ndarray
    shift: np.ndarray | None = None


class Mesh(NamedTuple):
    """A meshed pillar or rock mass.

    cell : "interval", "triangle", "quadrilateral", "tetrahedron" or "hexahedron".
    parts : the pieces of rock; no two share a vertex.
    layers : indices of the pillar's joints meshed as layers of rock; the material of
        layers[k - 1] is k.
    joints : the facet pairs between copies.
    sides : the facets on the boundary by name: of a pillar "start" and "end", the faces y = 0 and
        y = length; of a rock mass those of its partition's sides.
    """

    cell: str
    parts: tuple[Part, ...]
    layers: tuple[int, ...]
    joints: Joints
    sides: Mapping[str, Side]

    @property
    def materials(self) -> int:
        """Number of materials."""
        return 1 + max(int(part.material.max()) for part in self.parts)

    @property
    def start(self) -> Side:
        """The loaded end face of a pillar."""
        return self.sides["start"]

    @property
    def end(self) -> Side:
        """The other end face of a pillar."""
        return self.sides["end"]
