"""Joints that end in rock, periodic sides, pillars, rock of a script, and refusals in one line."""

import dolfinx.fem.petsc
import numpy as np
import pytest
import ufl
from dolfinx import fem
from scipy.sparse.linalg import spsolve

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space import rock
from jointwave.continuum.space.compat import cell_nodes
from tests.continuum.bodies import LAME, SHEAR, springs

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
    assert closed.joints.matrix.shape == (0, 2 * len(closed.x))
    opens = made(joint, continuum={"size": 0.6}, regions=regions).body
    assert np.allclose(opens.joints.place, [[3.0, 2.0]] * 2)
    assert np.isclose(opens.joints.weight.sum(), 0.5)


def test_without_springs_each_block_moves_alone(made):
    body = made({"dip": 30.0, "through": [3.0, 2.0]}, continuum={"size": 2.0}).body
    assert rigid_motions(body.stiffness) == 6
    assert rigid_motions(body.stiffness + springs(body)) == 3


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
    assert np.abs(body.joints.matrix @ u).max() < 1e-15
    assert rigid_motions(body.stiffness) == 6
    assert rigid_motions(body.stiffness + springs(body)) == 2


def test_bricks_may_face_others_across_periodic_sides(made):
    """Three rows, each offset by 0.3 of a brick: the bottom's ends are not those of the top."""
    beds = {"name": "beds", "dip": 0.0, "spacing": 1.0}
    heads = {"dip": 90.0, "spacing": 1.5, "ends_at": ["beds"], "offset": 0.3}
    sides = {"bottom": "periodic", "top": "periodic"}
    found = made(
        beds, heads, continuum={"size": 0.6}, boundaries=sides, domain={"size": [6.0, 3.0]}
    )
    body, (across,) = found.body, found.across
    assert len(across.contacts) > 5  # than four or five bricks of one row
    reaches = body.joints.column >= len(found.blocks.contacts)
    assert np.isclose(body.joints.weight[reaches].sum(), 6.0)
    assert np.abs(body.joints.matrix @ np.tile([0.3, -0.2], len(body.x))).max() < 1e-15


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


def test_the_equivalent_rock_has_no_joints_of_a_spacing(made):
    one, other = {"dip": 20.0, "spacing": 1.5}, {"dip": 70.0, "through": [3.0, 2.0]}
    found = made(one, other, model="equivalent")
    assert [single.name for single in found.scene.joint_sets] == ["set 1"]
    assert found.blocks.count == 2


@pytest.mark.parametrize(("dim", "order"), [(2, 1), (2, 3), (3, 2)])
def test_matrices_are_those_that_dolfinx_assembles(made, dim, order):
    """The same forms, written by hand on the body's space; in boxes all rules are exact to the
    order that they state."""
    dip = {"dip": 0.0, "spacing": 2.0}
    body = made(dip, dim=dim, continuum={"order": order, "size": 2.0}).body
    u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    strain = ufl.sym(ufl.grad(u))
    stress = LAME * ufl.tr(strain) * ufl.Identity(dim) + 2 * SHEAR * strain
    for form, own in (
        (ufl.inner(stress, ufl.sym(ufl.grad(v))), body.stiffness.toarray()),
        (2600.0 * ufl.inner(u, v), np.diag(body.mass)),
    ):
        found = dolfinx.fem.petsc.assemble_matrix(fem.form(form * ufl.dx(metadata=rule)))
        found.assemble()
        expected = found.convert("dense").getDenseArray().real
        assert np.abs(own - expected).max() < 1e-13 * np.abs(expected).max()


def test_a_script_gives_its_own_rock(made):
    """Rock that stiffens with depth, in UFL: its energy in a uniform strain."""

    def deep(scene, space):
        x = ufl.SpatialCoordinate(space.mesh)
        return rock.isotropic(space, 2600.0, 0.0 * x[0], 1e10 * (1 + (4.0 - x[1])), 1e-4)

    body = made({"dip": 0.0, "through": [3.0, 1.0]}, rock=deep).body
    u = (body.x * [1e-4, 0.0]).ravel()
    assert np.isclose(u @ body.stiffness @ u, 2 * 1e10 * 1e-8 * 6.0 * (4.0 + 8.0), rtol=1e-12)
    away = np.abs(body.damping - 1e-4 * body.stiffness).max()
    assert away < 1e-14 * np.abs(body.damping).max()


@pytest.mark.parametrize(
    ("changes", "dim", "components"),
    [
        ({}, 1, 1),
        ({"load__direction": [1.0, 0.0, 0.0], "motion": {"rotation": "none"}}, 1, 3),
        ({"load__direction": [1.0, 0.0, 0.0]}, 2, 2),
        ({"load__direction": [0.0, 0.0, 1.0]}, 3, 3),
        ({"numerics__continuum__dim": 2}, 2, 2),
        ({"numerics__continuum__dim": 2, "numerics__continuum__cell": "simplex"}, 2, 2),
    ],
)
def test_a_pillar_has_as_many_dimensions_as_its_motion_asks_for(pillar, changes, dim, components):
    keys = {"numerics__continuum__elements_per_block": 2, "rock__intact_modulus": 5e10} | changes
    scene = pillar(**keys)
    found = body_of(scene)
    body, p = found.body, calibrate(scene)
    assert (body.x.shape[1], body.components) == (dim, components)
    area = scene.pillar.side ** (dim - 1)
    mass = p.density * area * scene.pillar.length
    assert np.allclose(body.mass.reshape(-1, components).sum(axis=0), mass, rtol=1e-12)
    assert np.isclose(body.sides["start"].weight.sum(), area, rtol=1e-12)
    assert np.allclose(body.sides["end"].normal[:, components // 2], 1.0)
    joints = body.joints
    axis = min(1, components - 1)
    assert np.allclose(joints.frame[:, 0, axis], 1.0)
    assert np.allclose(joints.place[:, dim // 2], p.joint_y[joints.column], atol=1e-12)
    weight = np.bincount(joints.column, joints.weight)
    assert np.allclose(weight, area, rtol=1e-12) and len(weight) == p.block_count - 1
    along = np.zeros((len(body.x), components))
    along[:, axis] = body.x[:, dim // 2]
    stored = along.ravel() @ body.stiffness @ along.ravel()  # of terms (length over element)^2
    modulus = 5e10 if dim == 1 else found.materials[0].stiffness[1, 1]
    assert np.isclose(stored, modulus * area * scene.pillar.length, rtol=1e-10)


@pytest.mark.parametrize("order", [1, 4])
def test_a_layer_of_a_thickness_is_soft_rock(pillar, order):
    """A bar under a stress at its end is longer by its rock and by the layer's own compliance."""
    layer = {"y": 20.0, "normal_stiffness": 1e8, "thickness": 0.2}
    keys = {"soft_layers": [layer], "numerics__continuum": {"order": order}}
    scene = pillar(**keys)
    found = body_of(scene, "equivalent")
    body, modulus, length = found.body, calibrate(scene).modulus, scene.pillar.length
    assert body.joints is None
    assert np.isclose(found.blocks.volume[found.blocks.body.region == 1].sum(), 0.2)
    start, end = body.sides["start"].node, body.sides["end"].node
    free = np.setdiff1d(np.arange(len(body.x)), start)
    u = spsolve(body.stiffness[free][:, free].tocsc(), (free == end) * 1e6)
    expected = 1e6 * ((length - 0.2) / modulus + 1 / 1e8)
    assert np.isclose(u[free == end], expected, rtol=1e-9)


def test_mistakes_are_told_in_one_line(made):
    thirds = [{"dip": dip, "spacing": 2.0} for dip in (0.0, 50.0)]
    with pytest.raises(SceneError, match=r"numerics\.continuum\.order = 3: must be at most 2"):
        made(*thirds, continuum={"order": 3})
    with pytest.raises(SceneError, match=r"numerics\.continuum\.cell.*four edges"):
        made(*thirds, continuum={"cell": "quadrilateral"})
