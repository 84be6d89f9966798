"""Meshes of the pillar: exact sizes, pieces and copies, facets in pairs, and layers."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jointwave.continuum.mesh.pillar import elements_in_block, pillar_mesh

KINDS = [
    (1, "hexahedron"),
    (2, "hexahedron"),
    (2, "simplex"),
    (3, "hexahedron"),
    (3, "simplex"),
]
IN_A_BOX = {"interval": 1, "quadrilateral": 1, "triangle": 2, "hexahedron": 1, "tetrahedron": 6}

kinds = pytest.mark.parametrize(("dim", "cell"), KINDS)


def test_three_blocks_of_hexahedra(properties):
    """The whole mesh by hand: one element a block, the corners in tensor order."""
    mesh = pillar_mesh(properties(3), 3, "hexahedron", 1, 1, np.arange(2))
    (part,) = mesh.parts
    box = [(x, y, z) for z in (-0.2, 0.2) for y in (0.0, 0.5) for x in (-0.2, 0.2)]
    assert part.x[part.cells[0]].tolist() == [list(corner) for corner in box]
    assert mesh.joints.left.tolist() == [0, 1] and mesh.joints.right.tolist() == [1, 2]
    face = [[x, 0.5, z] for z in (-0.2, 0.2) for x in (-0.2, 0.2)]
    assert mesh.joints.corners[0].tolist() == face


@kinds
def test_a_layer_is_rock_between_shorter_blocks(dim, cell, properties, volumes, areas):
    p, cut = properties(8), np.array([0, 1, 5, 6])
    mesh = pillar_mesh(p, dim, cell, 3, 2, cut, {4: 0.1, 2: 0.05})
    assert mesh.layers == (2, 4)
    along = min(1, dim - 1)
    (part,) = (part for part in mesh.parts if part.material.any())
    assert part.shifts[0, along] == 1.0
    volume, middle = volumes(mesh, part), part.x[part.cells].mean(axis=1)[:, along]
    edges = {0: [0.0, 2.0], 1: [0.475, 0.525], 2: [1.45, 1.55]}
    for k, (low, high) in edges.items():
        inside = part.material == k
        assert ((middle > low) & (middle < high))[inside].all()
        y = part.x[part.cells[inside], along]
        assert (y.min(), y.max()) == pytest.approx((low, high), rel=1e-15)
    section = 0.4 ** (dim - 1)
    found = np.bincount(part.material, volume) / section
    assert found == pytest.approx([2.0 - 0.15, 0.05, 0.1], rel=1e-13)
    rows = IN_A_BOX[mesh.cell] * 2 ** (dim - 1)
    assert np.bincount(part.material).tolist() == [4 * 3 * rows, rows, rows]
    assert np.unique(mesh.joints.joint).tolist() == cut.tolist()


@given(
    roles=st.lists(st.sampled_from(["cut", "layer", "rock"]), min_size=1, max_size=30),
    elements=st.integers(1, 4),
    thickness=st.floats(1e-3, 0.49),
)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
def test_any_mix_of_joints_fills_the_pillar(roles, elements, thickness, properties):
    p = properties(len(roles) + 1)
    cut, layers = ([j for j, role in enumerate(roles) if role == kind] for kind in ("cut", "layer"))
    mesh = pillar_mesh(
        p, 1, "simplex", elements, 1, np.array(cut, dtype=int), dict.fromkeys(layers, thickness)
    )
    assert mesh.joints.joint.tolist() == cut and mesh.layers == tuple(layers)
    assert sum(part.copies for part in mesh.parts) == len(cut) + 1
    cells = [
        (part.shifts[:, None] + part.x[part.cells][..., 0]).reshape(-1, 2) for part in mesh.parts
    ]
    ends = np.concatenate(cells)
    ends = ends[np.argsort(ends[:, 0])]
    # Neighbours meet to round-off of their place, cells are no thinner than asked for.
    assert ends[1:, 0] == pytest.approx(ends[:-1, 1], rel=1e-15, abs=1e-15)
    assert (ends[0, 0], ends[-1, 1]) == pytest.approx((0.0, 0.5 * p.block_count), rel=1e-15)
    size = np.diff(ends, axis=1)
    assert size.min() >= min(thickness, (0.5 - thickness) / elements) * (1 - 1e-12)
    assert len(ends) == elements * p.block_count + len(layers)
    for k, joint in enumerate(layers):
        middle = [
            (part.x[cell].mean() + part.shifts[0, 0])
            for part in mesh.parts
            for cell in part.cells[part.material == k + 1]
        ]
        assert middle == pytest.approx([p.joint_y[joint]], rel=1e-12)


def test_what_cannot_be_meshed_is_refused(properties):
    p = properties(3)
    for layers in ({0: 1.0}, {0: 0.5, 1: 0.5}, {0: 0.4, 1: 0.6}):
        with pytest.raises(ValueError, match="leave nothing of block"):
            pillar_mesh(p, 1, "hexahedron", 1, 1, np.array([]), layers)
    with pytest.raises(ValueError, match="joint 1 is both an interface and a layer"):
        pillar_mesh(p, 1, "hexahedron", 1, 1, np.arange(2), {1: 0.1})


def test_waves_cross_an_element_within_the_limit():
    assert elements_in_block(0.5, 6000.0, 0.01) == 1
    assert elements_in_block(0.5, 5000.0, 0.01) == 1
    assert elements_in_block(0.5, 2500.0, 0.01) == 2
    assert elements_in_block(0.5, 1350.0, 0.01) == 4
    assert elements_in_block(0.5, 1350.0, 0.01, damped=True) == 1
