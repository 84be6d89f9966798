"""Facets, corner orders and orientation of every kind of cell against basix and gmsh."""

import basix
import numpy as np
import pytest

from jointwave.cases.gmsh_file import FROM_GMSH
from jointwave.continuum.mesh.cells import (
    CORNERS,
    DIMENSION,
    FACETS,
    MIRRORED,
    jacobians,
    oriented,
)
from jointwave.continuum.mesh.session import gmsh_session

GMSH_NAME = {
    "interval": "Line",
    "triangle": "Triangle",
    "quadrilateral": "Quadrangle",
    "tetrahedron": "Tetrahedron",
    "hexahedron": "Hexahedron",
}

kinds = pytest.mark.parametrize("kind", DIMENSION)


def reference(kind):
    return np.asarray(basix.geometry(getattr(basix.CellType, kind)))


@kinds
def test_facets_are_those_of_basix(kind):
    table = basix.topology(getattr(basix.CellType, kind))[DIMENSION[kind] - 1]
    assert FACETS[kind].tolist() == table
    assert len(reference(kind)) == CORNERS[kind]


@kinds
def test_gmsh_cell_in_basix_order_is_the_reference_cell(kind):
    with gmsh_session() as gmsh:
        number = gmsh.model.mesh.getElementType(GMSH_NAME[kind], 1)
        _, dim, _, _, x, _ = gmsh.model.mesh.getElementProperties(number)
        x = np.array(x).reshape(-1, dim)
    if kind in ("interval", "quadrilateral", "hexahedron"):
        x = (x + 1) / 2  # gmsh's goes from -1 to 1
    assert (x[FROM_GMSH[kind]] == reference(kind)).all()


@kinds
def test_jacobian_of_the_reference_cell_is_one_and_of_its_mirror_image_minus_one(kind):
    x, cells = reference(kind), np.arange(CORNERS[kind])[None]
    assert jacobians(kind, x, cells) == pytest.approx(1.0, abs=0)
    assert jacobians(kind, x, cells[:, MIRRORED[kind]]) == pytest.approx(-1.0, abs=0)


@kinds
def test_jacobian_is_that_of_the_map(kind):
    """A linear map has its determinant at every corner."""
    dim = DIMENSION[kind]
    matrix = np.random.default_rng(dim).normal(size=(dim, dim))
    x, cells = reference(kind) @ matrix.T, np.arange(CORNERS[kind])[None]
    assert jacobians(kind, x, cells) == pytest.approx(np.linalg.det(matrix), rel=1e-12)


@kinds
def test_only_mirrored_cells_are_turned(kind):
    x, right = reference(kind), np.arange(CORNERS[kind])
    cells = np.stack([right, right[MIRRORED[kind]]])
    turned = oriented(kind, x, cells)
    assert (jacobians(kind, x, turned) > 0).all()
    assert (turned[0] == right).all()
    assert {*map(tuple, np.sort(turned, axis=1))} == {tuple(right)}


def test_a_cell_turned_inside_out_at_one_corner_is_left_and_told():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.2, 0.2]])
    cells = np.arange(4)[None]
    assert (oriented("quadrilateral", x, cells) == cells).all()
    signs = np.sign(jacobians("quadrilateral", x, cells))
    assert signs.tolist() == [[1, 1, 1, -1]]
