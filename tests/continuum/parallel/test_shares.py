"""What the processes hold adds up to the whole: stiffness, mass, joints."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags

from cases.material.calibrate import calibrate
from continuum.mesh.pillar import pillar_mesh
from continuum.parallel.body import held_share
from continuum.parallel.partition import ranks_of_cells, restrict
from continuum.space.body import build_body, whole
from continuum.space.elasticity import Material, Section
from continuum.space.interface import jumps

ROCK, LAYER = Material(8.64e10, 0.25, 2400.0), Material(1e9, 0.0, 2400.0)

ROUND_OFF = 1e-13  # of the largest entry; entries are sums of a few dozen, in another order

KINDS = [(1, "hexahedron", 2), (2, "hexahedron", 3), (2, "simplex", 2), (3, "hexahedron", 1)]


def to_whole(body, held):
    """Return the matrix [whole freedoms, freedoms] that puts what a process holds where the whole
    body has it."""
    components, here = np.arange(body.section.components), held.cells[:, 0] >= 0
    ours = held.freedom(held.cells[here][..., None], components).ravel()
    theirs = body.freedom(body.cells[here][..., None], components).ravel()
    pairs = np.unique(np.stack([theirs, ours]), axis=1)
    assert np.unique(pairs[1]).size == pairs.shape[1]
    shape = body.mass.size, held.mass.size
    return csr_matrix((np.ones(pairs.shape[1]), (pairs[0], pairs[1])), shape)


def bonds(across):
    """Return B^T W B of all directions, as joints of one stiffness would have it."""
    matrices = across.matrices
    return sum(m.T @ diags(across.weight) @ m for m in matrices)


def alike(found, expected):
    """Assert that two matrices differ by round-off alone."""
    assert abs(found - expected).max() < ROUND_OFF * abs(expected).max()


@pytest.mark.parametrize(("dim", "cell", "order"), KINDS)
@pytest.mark.parametrize("size", [2, 3, 7])
@pytest.mark.parametrize("seed", [None, 0], ids=["along the pillar", "at random"])
def test_shares_add_up_to_the_whole(dim, cell, order, size, seed, pillar):
    """Cut between blocks, through blocks and through a layer: nothing is lost or counted twice."""
    p = calibrate(pillar(pillar__length=3.0, record={"stress": [0.5]}))
    mesh = pillar_mesh(p, dim, cell, 2, 2, np.array([0, 1, 4]), {2: 0.02})
    body = build_body(mesh, order, [ROCK, LAYER], Section(dim, 0.25))
    rank_of = ranks_of_cells(mesh, size)
    if seed is not None:
        rank_of = np.random.default_rng(seed).permutation(rank_of)
    stiffness = mass = joints = 0.0
    for rank in range(size):
        share = restrict(mesh, rank_of, rank)
        held, across = held_share(mesh, share, order, [ROCK, LAYER], body.section)
        place = to_whole(body, held)
        stiffness = stiffness + place @ whole(held.layout, held.mesh, held.blocks) @ place.T
        assert np.isfinite(held.mass).all()
        mass = mass + place @ held.mass
        joints = joints + (0.0 if across is None else place @ bonds(across) @ place.T)
    expected = whole(body.layout, mesh, body.blocks)
    alike(stiffness, expected)
    moves = expected.diagonal() > 0
    assert np.abs(mass - body.mass)[moves].max() < ROUND_OFF * body.mass.max()
    alike(joints, bonds(jumps(body)))
