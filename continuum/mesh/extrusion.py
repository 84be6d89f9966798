"""A straight piece of the pillar: its section, extruded along y."""

from typing import NamedTuple

import numpy as np

from jointwave.continuum.body.session import gmsh_session
from jointwave.continuum.mesh.cells import CORNERS, DIMENSION, oriented


class Column(NamedTuple):
    """Rows of cells along y.

    edges : float array [rows + 1], m, ends of the rows, from 0.
    material : int array [rows].
    """

    edges: np.ndarray
    material: np.ndarray


def extruded(
    kind: str, side: float, across: int, column: Column
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices [n, dim] (m), cells [n, corners] and material [n] of a column of rock.

    The section `side` (m) is centred on the axis, with `across` elements in each direction. Both
    ends carry the same mesh, so that columns conform. Vertices and cells are numbered along y.
    """
    rows = len(column.material)
    if kind == "interval":
        vertex = np.arange(rows + 1)
        return column.edges[:, None], np.column_stack([vertex[:-1], vertex[1:]]), column.material
    grid, cells = (_tetrahedra if kind == "tetrahedron" else _grid)(kind, across, rows)
    x = np.empty(grid.shape)
    x[:, ::2] = side * (grid[:, ::2] / across - 0.5)
    x[:, 1] = column.edges[grid[:, 1]]
    row = grid[cells, 1].min(axis=1)
    return x, oriented(kind, x, cells), column.material[row]


def _grid(kind: str, across: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices [n, dim] and cells of a column of unit cells, all in whole numbers."""
    dim = DIMENSION[kind]
    order = [1, 2, 0] if dim == 3 else [1, 0]  # numbered along x first, then z, then y
    counts = np.array([across, rows, across])[order]

    def points(counts: np.ndarray) -> np.ndarray:
        found = np.empty((counts.prod(), dim), dtype=np.int64)
        found[:, order] = np.indices([*counts]).reshape(dim, -1).T
        return found

    corner = np.array([*np.ndindex(*dim * [2])])[:, ::-1]
    corners = points(counts)[:, None] + corner
    cells = np.ravel_multi_index([*np.moveaxis(corners, 2, 0)[order]], [*(counts + 1)])
    if kind == "triangle":
        cells = cells[:, [[0, 1, 3], [0, 2, 3]]].reshape(-1, 3)
    return points(counts + 1), cells


def _tetrahedra(kind: str, across: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Return `_grid` of tetrahedra, by gmsh."""
    with gmsh_session() as gmsh:
        _mesh_column(gmsh, across, rows)
        tags, x, _ = gmsh.model.mesh.getNodes()
        (tagged,) = gmsh.model.mesh.getElements(3)[2]
        # gmsh's own arrays are freed with its session.
        grid, tags, tagged = np.rint(x).astype(np.int64), np.array(tags), np.array(tagged)
    # The section is gmsh's x-y plane: its (x, y, z) are the pillar's (z, x, y).
    grid, along = grid.reshape(-1, 3)[:, [1, 2, 0]], [0, 2, 1]
    place = np.lexsort(grid[:, along].T)
    number = np.empty(int(tags.max()) + 1, dtype=np.int64)
    number[tags[place]] = np.arange(place.size)
    grid, cells = grid[place], number[tagged].reshape(-1, CORNERS[kind])
    # Corners in order of z, y, x, then cells along the pillar.
    cells = np.take_along_axis(cells, np.lexsort(grid[cells].transpose(2, 0, 1)), axis=1)
    return grid, cells[np.lexsort(grid[cells].sum(axis=1)[:, along].T)]


def _mesh_column(gmsh, across: int, rows: int) -> None:
    """Mesh a column of `across` unit cells in both directions and `rows` along gmsh's last axis."""
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    section = (2, occ.addRectangle(0, 0, 0, across, across))
    occ.synchronize()
    curves = gmsh.model.getBoundary([section], oriented=False)
    occ.extrude([section], 0, 0, rows, numElements=[rows])
    occ.synchronize()
    for _, curve in curves:
        mesh.setTransfiniteCurve(curve, across + 1)
    mesh.setTransfiniteSurface(section[1])
    mesh.generate(3)
