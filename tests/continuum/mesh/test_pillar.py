"""Meshes of the pillar: exact sizes, pieces and copies, facets in pairs, and layers."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jointwave.continuum.mesh.cells import jacobians
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
cuts = pytest.mark.parametrize("cut", [[], [2], [0, 1, 2, 3, 4, 5, 6], [1, 4, 5]])


@kinds
@cuts
def test_volume_and_mean_are_those_of_the_pillar(dim, cell, cut, properties, volumes):
    p = properties(8)
    mesh = pillar_mesh(p, dim, cell, 3, 2, np.array(cut, dtype=int))
    volume = sum(part.copies * volumes(mesh, part).sum() for part in mesh.parts)
    assert volume == pytest.approx(4.0 * 0.4 ** (dim - 1), rel=1e-14)
    x = np.concatenate([(part.shifts[:, None] + part.x).reshape(-1, dim) for part in mesh.parts])
    half = np.array([-0.2, 0.0, -0.2])[[0, 1, 2][:dim] if dim > 1 else [1]]
    assert (x.min(axis=0) == half).all()
    assert x.max(axis=0) == pytest.approx([4.0 if low == 0 else -low for low in half], abs=0)


@kinds
@cuts
def test_every_interface_is_held_over_its_whole_section(dim, cell, cut, properties, areas):
    p = properties(8)
    mesh = pillar_mesh(p, dim, cell, 3, 2, np.array(cut, dtype=int))
    joints, along = mesh.joints, min(1, dim - 1)
    assert np.unique(joints.joint).tolist() == cut
    y = p.joint_y[joints.joint]
    # Both are sums and products of numbers up to 4, rounded twice at most.
    assert np.abs(joints.corners[..., along] - y[:, None]).max(initial=0) <= 2 * np.spacing(4.0)
    area = areas(joints.corners)
    for joint in cut:
        assert area[joints.joint == joint].sum() == pytest.approx(0.4 ** (dim - 1), rel=1e-14)
    for side, place in ((mesh.start, 0.0), (mesh.end, 4.0)):
        assert areas(side.corners).sum() == pytest.approx(0.4 ** (dim - 1), rel=1e-14)
        assert (side.corners[..., along] == place).all()


@kinds
@cuts
def test_left_and_right_cells_touch_their_facet_from_either_side(
    dim, cell, cut, properties, located
):
    mesh = pillar_mesh(properties(8), dim, cell, 3, 2, np.array(cut, dtype=int))
    corners, middle = located(mesh)
    along, place = min(1, dim - 1), mesh.joints.corners.mean(axis=1)[:, min(1, dim - 1)]
    assert (middle[mesh.joints.left, along] < place).all()
    assert (middle[mesh.joints.right, along] > place).all()
    for cells in (mesh.joints.left, mesh.joints.right):
        apart = np.abs(corners[cells][:, None] - mesh.joints.corners[:, :, None]).max(axis=-1)
        assert apart.min(axis=2).max(initial=0) < 1e-14


@kinds
def test_jacobians_are_positive_and_cells_lie_along_the_axes(dim, cell, properties):
    mesh = pillar_mesh(properties(), dim, cell, 3, 2, np.arange(2))
    (part,) = mesh.parts
    det = jacobians(mesh.cell, part.x, part.cells)
    assert (det > 0).all()
    if cell == "hexahedron":
        corner = part.x[part.cells]
        for axis in range(dim):
            edge = corner[:, 1 << axis] - corner[:, 0]
            assert (edge[:, axis] > 0).all() and not np.delete(edge, axis, axis=1).any()


@kinds
def test_a_jointed_pillar_is_copies_of_one_block(dim, cell, properties):
    p = properties(8)
    mesh = pillar_mesh(p, dim, cell, 3, 2, np.arange(7))
    (part,) = mesh.parts
    assert part.shifts[:, min(1, dim - 1)].tolist() == (0.5 * np.arange(8)).tolist()
    assert not np.delete(part.shifts, min(1, dim - 1), axis=1).any()
    assert len(part.cells) == 3 * 2 ** (dim - 1) * IN_A_BOX[mesh.cell]
    assert len(part.x) == 4 * 3 ** (dim - 1)
    assert not part.material.any() and mesh.layers == ()


def test_pieces_of_one_length_are_copies_of_one_part(properties):
    mesh = pillar_mesh(properties(8), 2, "hexahedron", 3, 1, np.array([5, 1, 4]))
    found = [(len(part.cells), part.shifts[:, 1].tolist()) for part in mesh.parts]
    assert found == [(6, [0.0, 3.0]), (9, [1.0]), (3, [2.5])]
    # Cells are numbered by parts and copies: the last of copy 0 holds the first of part 1.
    assert mesh.joints.joint.tolist() == [1, 4, 5]
    assert mesh.joints.left.tolist() == [5, 20, 21 + 2]
    assert mesh.joints.right.tolist() == [12, 21, 6]
    assert mesh.start.cell.tolist() == [0] and mesh.end.cell.tolist() == [11]


def test_three_blocks_of_hexahedra(properties):
    """The whole mesh by hand: one element a block, the corners in tensor order."""
    mesh = pillar_mesh(properties(3), 3, "hexahedron", 1, 1, np.arange(2))
    (part,) = mesh.parts
    box = [(x, y, z) for z in (-0.2, 0.2) for y in (0.0, 0.5) for x in (-0.2, 0.2)]
    assert part.x[part.cells[0]].tolist() == [list(corner) for corner in box]
    assert mesh.joints.left.tolist() == [0, 1] and mesh.joints.right.tolist() == [1, 2]
    face = [[x, 0.5, z] for z in (-0.2, 0.2) for x in (-0.2, 0.2)]
    assert mesh.joints.corners[0].tolist() == face


@pytest.mark.parametrize(("dim", "cell"), KINDS[1:])
def test_both_ends_of_a_part_carry_the_same_facets(dim, cell, properties):
    """Else neighbours would not conform; a part's own copies and other parts meet at all ends."""
    mesh = pillar_mesh(properties(8), dim, cell, 2, 3, np.array([1, 4, 5]))
    per_joint = np.bincount(mesh.joints.joint)[[1, 4, 5]]
    assert (per_joint == len(mesh.start.cell)).all()
    assert (
        len(mesh.start.cell)
        == len(mesh.end.cell)
        == 3 ** (dim - 1) * (2 if mesh.cell == "tetrahedron" else 1)
    )
    flat = [0, 2][: dim - 1]
    patterns = [
        {tuple(map(tuple, np.round(facet, 12))) for facet in side.corners[..., flat]}
        for side in (mesh.start, mesh.end)
    ]
    ordered = [{tuple(sorted(facet)) for facet in pattern} for pattern in patterns]
    assert ordered[0] == ordered[1]


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


@kinds
def test_blocks_beside_a_layer_have_equal_elements(dim, cell, properties):
    mesh = pillar_mesh(properties(3), dim, cell, 2, 1, np.array([]), {0: 0.1})
    y = np.unique(mesh.parts[0].x[:, min(1, dim - 1)])
    expected = [0, 0.225, 0.45, 0.55, 0.775, 1.0, 1.25, 1.5]
    assert y == pytest.approx(expected, rel=1e-14)
    assert mesh.joints.joint.size == 0 and mesh.joints.corners.shape[2] == dim


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
