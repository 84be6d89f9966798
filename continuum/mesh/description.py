"""A pillar's mesh in plain numpy: pieces of rock, and the facets that joints or loads act on."""

from typing import NamedTuple

import numpy as np


class Part(NamedTuple):
    """A connected piece of rock that stands at one or more places; copies share no vertices.

    x : float array [vertices, dim], m: (y,), (x, y) or (x, y, z); y along the pillar.
    cells : int array [cells, corners], vertex numbers in basix's corner order (the tensor order for
        quadrilaterals and hexahedra), with positive Jacobians.
    material : int array [cells], 0 the rock, k the k-th of `Mesh.layers` counted from 1.
    shifts : float array [copies, dim], m, added to x.
    """

    x: np.ndarray
    cells: np.ndarray
    material: np.ndarray
    shifts: np.ndarray

    @property
    def copies(self) -> int:
        """At how many places the part stands."""
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
    """Pairs of facets at the same place that joints hold together.

    joint : int array [facets], index of the pillar's joint whose law holds, 0 nearest the loaded
        end.
    left, right : int arrays [facets], cell numbers as in `Side`; left is the side towards y = 0.
    corners : float array [facets, facet corners, dim], m, of the left cell's facet.
    """

    joint: np.ndarray
    left: np.ndarray
    right: np.ndarray
    corners: np.ndarray


class Mesh(NamedTuple):
    """A meshed pillar.

    cell : "interval", "triangle", "quadrilateral", "tetrahedron" or "hexahedron".
    parts : the pieces of rock; no two share a vertex.
    layers : indices of the pillar's joints that are meshed as layers of rock; the material of
        layers[k - 1] is k.
    joints : the facet pairs between copies.
    start, end : the facets of the end faces y = 0 and y = length.
    """

    cell: str
    parts: tuple[Part, ...]
    layers: tuple[int, ...]
    joints: Joints
    start: Side
    end: Side
