"""Facets do not depend on how vertices and cells are numbered."""

import numpy as np
import pytest

from jointwave.continuum.mesh import facets
from jointwave.continuum.mesh.description import Part
from jointwave.continuum.mesh.facets import Facets
from jointwave.continuum.mesh.pillar import pillar_mesh

KINDS = [(1, "hexahedron"), (2, "hexahedron"), (2, "simplex"), (3, "hexahedron"), (3, "simplex")]


def renumbered(part: Part, how: str) -> Part:
    """Return the same rock with its vertices, cells and copies in another order."""
    shuffle = np.random.default_rng(1).permutation
    order = {"reversed": lambda n: np.arange(n)[::-1], "shuffled": shuffle}
    vertex, cell, copy = map(order[how], (len(part.x), len(part.cells), part.copies))
    number = np.empty_like(vertex)
    number[vertex] = np.arange(vertex.size)
    return Part(part.x[vertex], number[part.cells][cell], part.material[cell], part.shifts[copy])


@pytest.mark.parametrize("how", ["reversed", "shuffled"])
@pytest.mark.parametrize(("dim", "cell"), KINDS)
def test_left_is_towards_the_start_whatever_the_numbers(dim, cell, how, properties, located):
    mesh = pillar_mesh(properties(5), dim, cell, 2, 2, np.arange(4))
    mesh = mesh._replace(parts=tuple(renumbered(part, how) for part in mesh.parts))
    outer = facets.outer_facets(mesh.cell, mesh.parts)
    inner = outer.chosen(facets.lies_across(outer, 1e-9) & (outer.y > 0.1) & (outer.y < 2.4))
    pair = facets.pairs(inner)
    number = np.rint(inner.y[pair[:, 0]] / 0.5).astype(int) - 1
    joints = facets.joints(inner, pair, number)
    assert len(joints.joint) == len(mesh.joints.joint)
    _, middle = located(mesh)
    y = middle[:, min(1, dim - 1)]
    place = joints.corners.mean(axis=1)[:, min(1, dim - 1)]
    assert (y[joints.left] < place).all() and (y[joints.right] > place).all()


def one(corners, inside) -> Facets:
    return Facets(np.array([0]), np.array([corners], dtype=float), np.array([inside], dtype=float))


@pytest.mark.parametrize(
    ("corners", "inside", "left"),
    [
        # A steep joint: the cell's middle is above the facet's, but below its plane.
        ([(0, 0), (1, 3)], (0.9, 1.6), True),
        ([(1, 3), (0, 0)], (0.9, 1.6), True),
        ([(0, 0), (1, 3)], (0.1, 1.4), False),
        # Along the pillar left is towards negative x.
        ([(0, 0), (0, 1)], (-0.5, 0.5), True),
        ([(0, 1), (0, 0)], (0.5, 0.5), False),
        ([(0, 0), (1e-17, 1)], (-0.5, 0.5), True),
        ([(1e-17, 0), (0, 1)], (-0.5, 0.5), True),
    ],
)
def test_left_is_told_by_the_normal(corners, inside, left):
    assert facets.is_left(one(corners, inside)).tolist() == [left]


def test_left_of_a_joint_along_x_and_y_is_towards_negative_z():
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
    assert facets.is_left(one(corners, (0.5, 0.5, -1))).all()
    assert not facets.is_left(one(corners, (0.5, 0.5, 1))).any()


def test_facets_pair_by_their_corners_not_only_by_their_middle():
    """Two triangles of a square, split along either diagonal, share middles but not corners."""
    across = np.array([[(0, 0), (2, 0)], [(0.5, 0), (1.5, 0)], [(2, 0), (0, 0)]], dtype=float)
    middle = np.array([(1, -1), (1, 1), (1, 2)], dtype=float)
    assert facets.pairs(Facets(np.arange(3), across, middle)).tolist() == [[0, 2]]
    assert facets.pairs(Facets(np.array([0, 1, 0]), across, middle)).size == 0


def test_outer_facets_are_those_of_one_cell():
    cells = np.array([[0, 1, 3, 4], [1, 2, 4, 5]])
    cell, facet = facets.outer("quadrilateral", cells)
    assert list(zip(cell.tolist(), facet.tolist(), strict=True)) == [
        (0, 0),
        (0, 1),
        (0, 3),
        (1, 0),
        (1, 2),
        (1, 3),
    ]
