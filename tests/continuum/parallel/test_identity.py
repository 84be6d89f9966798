"""Telling the nodes that processes share by the mesh alone, against the numbers of the whole."""

import numpy as np
import pytest

from cases.material.calibrate import calibrate
from continuum.mesh.description import Joints, Mesh, Part, Side
from continuum.mesh.pillar import pillar_mesh
from continuum.parallel.identity import border, joined
from continuum.parallel.partition import ranks_of_cells
from continuum.parallel.serial import Pieces
from continuum.space.body import build_body
from continuum.space.elasticity import Material, Section

ROCK = Material(8.64e10, 0.25, 2400.0)
KINDS = [(1, "hexahedron", 4), (2, "hexahedron", 3), (2, "simplex", 2), (3, "hexahedron", 2)]
KINDS += [(3, "hexahedron", 4), (3, "simplex", 2), (3, "simplex", 1)]


@pytest.fixture
def whole(pillar):
    """Return a function that gives the body of a pillar with some of its joints, in one process."""

    def build(dim, cell, order, interfaces, plane_sections=False):
        p = calibrate(pillar(pillar__length=2.0, record={"stress": [0.5]}, soft_layers=[]))
        mesh = pillar_mesh(p, dim, cell, 2, 2, np.array(interfaces, dtype=np.int64))
        return build_body(mesh, order, [ROCK], Section(dim, 0.25), plane_sections)

    return build


def ranks(body, size, seed):
    """Return which processes cells belong to: as they are dealt out, or at random."""
    if seed is None:
        return ranks_of_cells(body.mesh, size)
    return np.random.default_rng(seed).integers(0, size, len(body.cells))


@pytest.mark.parametrize(("dim", "cell", "order"), KINDS)
@pytest.mark.parametrize("seed", [None, 0, 1])
@pytest.mark.parametrize("interfaces", [[], [0, 1, 2], [1]], ids=["one piece", "blocks", "two"])
def test_nodes_are_the_same_where_the_whole_body_says_so(dim, cell, order, seed, interfaces, whole):
    """Two nodes of cells on the border have one name exactly if the body gives them one number;
    every node that two processes' own cells have is on the border."""
    body = whole(dim, cell, order, interfaces)
    rank_of = ranks(body, 3, seed)
    found = border(body.mesh, rank_of, order)
    number = body.cells[found.cell].ravel()
    name = found.node.ravel()
    pairs = np.unique(np.stack([number, name], axis=1), axis=0)
    assert np.unique(pairs[:, 0]).size == np.unique(pairs[:, 1]).size == len(pairs)
    of_ranks = [set(body.cells[rank_of == rank].ravel()) for rank in range(3)]
    shared = (of_ranks[0] & of_ranks[1]) | (of_ranks[0] & of_ranks[2]) | (of_ranks[1] & of_ranks[2])
    assert shared <= set(number)
    joints = body.mesh.joints
    crossing = rank_of[joints.left] != rank_of[joints.right]
    assert set(joints.right[crossing]) <= set(found.cell)


@pytest.mark.parametrize(("dim", "cell", "order"), [k for k in KINDS if k[0] > 1])
@pytest.mark.parametrize("interfaces", [[], [0, 1, 2]], ids=["one piece", "blocks"])
def test_plane_sections_tie_all_nodes_at_one_height_of_a_piece(dim, cell, order, interfaces, whole):
    """Names are those of the freedoms that the body ties them to, whoever has the cells."""
    body = whole(dim, cell, order, interfaces, plane_sections=True)
    rank_of = ranks(body, 5, 2)
    found = border(body.mesh, rank_of, order, plane_sections=True)
    freedom = body.first[body.cells[found.cell]].ravel()
    pairs = np.unique(np.stack([freedom, found.node.ravel()], axis=1), axis=0)
    assert np.unique(pairs[:, 0]).size == np.unique(pairs[:, 1]).size == len(pairs)
    assert found.cell.size == len(body.cells)


def notch() -> Mesh:
    """Return four squares around (0, 0.75) with a joint from there to the right."""
    x = np.array([(x, y) for y in (0.0, 0.75, 1.5) for x in (-0.2, 0.0, 0.2)] + [(0.2, 0.75)])
    cells = np.array([[0, 1, 3, 4], [1, 2, 4, 5], [3, 4, 6, 7], [4, 9, 7, 8]])
    part = Part(x, cells, np.zeros(4, dtype=np.int64), np.zeros((1, 2)))
    joints = Joints(np.array([0]), np.array([1]), np.array([3]), x[None, [4, 5]])
    start, end = Side(np.array([0, 1]), x[cells[:2, :2]]), Side(np.array([2, 3]), x[cells[2:, 2:]])
    return Mesh("quadrilateral", (part,), (), joints, {"start": start, "end": end})


@pytest.mark.parametrize("rank_of", [[0, 0, 1, 1], [0, 1, 1, 2], [0, 1, 2, 0], [0, 0, 0, 1]])
def test_the_two_sides_of_a_joint_that_ends_inside_the_rock_are_not_the_same(rank_of):
    """Their nodes lie at one place in one piece, which coordinates could not tell apart."""
    mesh = notch()
    body = build_body(mesh, 2, [ROCK], Section(2, 1.0))
    found = border(mesh, np.array(rank_of), 2)
    assert found.cell.tolist() == [0, 1, 2, 3]
    pairs = np.unique(np.stack([body.cells.ravel(), found.node.ravel()]), axis=1)
    assert pairs.shape[1] == len(body.x) == len(np.unique(pairs[1]))


@pytest.mark.parametrize("size", [1, 2, 4])
@pytest.mark.parametrize("seed", [None, 3])
@pytest.mark.parametrize("interfaces", [[], [0, 2]], ids=["one piece", "three"])
def test_joined_pieces_are_the_whole(size, seed, interfaces, whole):
    """Cells in their order, every node once, values where they belong."""
    body = whole(2, "hexahedron", 3, interfaces)
    rank_of = ranks(body, size, seed)
    pieces = []
    for rank in range(size):
        cell = np.flatnonzero(rank_of == rank)
        nodes, table = np.unique(body.cells[cell], return_inverse=True)
        table = table.reshape(cell.size, -1)
        pieces.append(Pieces(cell, table, (cell,), (body.x[nodes], nodes)))
    found = joined(pieces, border(body.mesh, rank_of, body.order))
    x, nodes = found.of_nodes
    assert found.cell.tolist() == found.of_cells[0].tolist() == list(range(len(body.cells)))
    assert (nodes[found.table] == body.cells).all() and len(x) == len(body.x)
    assert (x == body.x[nodes]).all()
