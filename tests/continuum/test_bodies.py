"""Joints that end in rock, periodic sides, equal blocks, and refusals in one line."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.continuum.space.compat import cell_nodes
from tests.continuum.bodies import springs

SMALL = 1e-9  # of the stiffness: the eigenvalues of rigid motions
HALF = {"regions": [{"name": "upper", "dip": 0.0, "through": [0.0, 2.1]}]}


def rigid_motions(matrix) -> int:
    values = np.linalg.eigvalsh(matrix.toarray())
    return int((values < SMALL * values.max()).sum())


def test_a_joint_that_ends_in_rock_leaves_it_in_one_piece(made):
    joint = {"dip": 90.0, "through": [3.0, 3.0], "regions": ["upper"]}
    found = made(joint, continuum={"size": 1.0}, **HALF)
    body = found.body
    assert rigid_motions(body.stiffness) == 3
    length = found.blocks.contacts.area[found.blocks.contacts.joint_set == 0].sum()
    tip = body.joints.place[:, 1].min()
    assert np.isclose(length, 4.0 - 2.1)
    assert 2.1 < tip < 3.2  # the node at the end is one, and stands for the rest
    assert np.isclose(body.joints.weight.sum() + (tip - 2.1) / 2, length)


def test_a_joint_of_one_element_within_rock_is_told(made, caplog):
    """Both of its nodes are at its ends; with two elements it opens at the one between them."""
    lines = {"band": 1.5, "top": 2.5}
    regions = [{"name": k, "dip": 0.0, "through": [0.0, y]} for k, y in lines.items()]
    joint = {"dip": 90.0, "through": [3.0, 2.0], "regions": ["band"]}
    closed = made(joint, continuum={"size": 1.5}, regions=regions).body
    assert "1 of 1 facets of joints have all nodes at the ends of joints" in caplog.text
    assert len(closed.joints.weight) == 0
    opens = made(joint, continuum={"size": 0.6}, regions=regions).body
    assert np.allclose(opens.joints.place, [[3.0, 2.0]] * 2)
    assert np.isclose(opens.joints.weight.sum(), 0.5)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("dip", [0.0, 90.0])
def test_rock_across_periodic_sides_is_one(made, cell, dip):
    """It can move, not turn; uniform stretch is against it."""
    periodic = {"left": "periodic", "right": "periodic"}
    joint = {"dip": dip, "through": [2.0, 2.0]}
    found = made(joint, continuum={"cell": cell}, boundaries=periodic)
    body = found.body
    assert body.tied is not None and body.tied.max() + 1 == len(body.x)
    assert np.allclose(body.mass.sum(), 2 * 2600.0 * 24.0, rtol=1e-13)
    assert rigid_motions(body.stiffness + springs(body)) == 2


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_a_joint_along_periodic_sides_joins_them(made, cell):
    periodic = {"left": "periodic", "right": "periodic"}
    joint = {"dip": 90.0, "spacing": 3.0, "through": [0.0, 2.0]}
    found = made(joint, continuum={"cell": cell}, boundaries=periodic)
    body, across = found.body, found.body.joints.column >= len(found.blocks.contacts)
    assert body.tied is None
    assert np.isclose(body.joints.weight[across].sum(), 4.0)
    assert np.allclose(body.joints.frame[across, 0], [1.0, 0.0])
    u = np.tile([0.3, -0.2], len(body.x))
    assert np.abs(body.joints.jumps(u)).max() < 1e-15
    assert rigid_motions(body.stiffness) == 6
    assert rigid_motions(body.stiffness + springs(body)) == 2


def test_bricks_may_face_others_across_periodic_sides(made):
    """Three rows, each offset by 0.3 of a brick: the bottom's ends are not those of the top."""
    beds = {"name": "beds", "dip": 0.0, "spacing": 1.0}
    heads = {"dip": 90.0, "spacing": 1.5, "ends_at": ["beds"], "offset": 0.3}
    tables = {"domain": {"size": [6.0, 3.0]}, "continuum": {"size": 0.6}}
    found = made(beds, heads, boundaries={"bottom": "periodic", "top": "periodic"}, **tables)
    body, (across,) = found.body, found.across
    assert len(across.contacts) > 5  # than four or five bricks of one row
    reaches = body.joints.column >= len(found.blocks.contacts)
    assert np.isclose(body.joints.weight[reaches].sum(), 6.0)
    assert np.abs(body.joints.jumps(np.tile([0.3, -0.2], len(body.x)))).max() < 1e-15


def test_blocks_that_are_alike_have_the_same_mesh(made):
    """Whole bricks within a wall: cells at the same places of each, to round-off."""
    beds = {"name": "beds", "dip": 0.0, "spacing": 0.5}
    heads = {"dip": 90.0, "spacing": 1.0, "ends_at": ["beds"], "offset": 0.5}
    found = made(beds, heads, continuum={"size": 0.3})
    body, blocks = found.body, found.blocks
    middles = body.x[cell_nodes(body.space)].mean(axis=1) - blocks.centroid[body.block]
    edge = np.zeros(blocks.count, bool)
    edge[blocks.boundary.blocks[:, 0]] = True
    inner = np.flatnonzero(~edge)
    first, *others = (middles[body.block == k] for k in inner)
    assert len(others) > 20 and len(first) > 10
    for one in others:
        away = np.linalg.norm(first[:, None] - one, axis=2).min(axis=1)
        assert len(one) == len(first) and away.max() < 1e-12


def test_mistakes_are_told_in_one_line(made):
    thirds = [{"dip": dip, "spacing": 2.0} for dip in (0.0, 50.0)]
    with pytest.raises(SceneError, match=r"numerics\.continuum\.order = 3: must be at most 2"):
        made(*thirds, continuum={"order": 3})
    with pytest.raises(SceneError, match=r"numerics\.continuum\.cell.*four edges"):
        made(*thirds, continuum={"cell": "quadrilateral"})
    near = [{"dip": 0.0, "through": [1.0, y]} for y in (2.0, 2.0 + 1e-7)]
    with pytest.raises(SceneError, match=r"edges shorter than 6e-07 m .* nearly meet, near \["):
        domain = {"size": [6.0, 4.0], "least_width": 1e-8}
        made(*near, domain=domain, continuum={"cell": "triangle"})
