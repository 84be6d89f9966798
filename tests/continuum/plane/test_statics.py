"""Rock and joints in equilibrium: what every mesh has to reproduce exactly, or at its order."""

import numpy as np
import pytest

from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.periodic import of_all
from jointwave.continuum.build import operators
from jointwave.continuum.space.evaluation import quadrature_in

#: xx, yy, xy, Pa, tension positive; the other where joints that end at others carry nothing: with
#: what they opened by, blocks at their ends would not fit together.
STRESS, UPRIGHT = np.array([-3e6, -1e6, 7e5]), np.array([0.0, -1e6, 0.0])

#: By name: joint sets, and what the mesh is made of.
MESHES = {
    "one joint": ([{"dip": 30, "through": [3, 3]}], {"order": 2}),
    "a lattice": ([{"dip": 0, "spacing": 2.0}, {"dip": 90, "spacing": 2.0}], {"order": 3}),
    "three sets": ([{"dip": 20, "spacing": 3.0}, {"dip": 110, "spacing": 3.0}], {"order": 2}),
    "brickwork": (
        [
            {"dip": 0, "spacing": 2.0},
            {"dip": 90, "spacing": 3.0, "ends_at": ["set 0"], "offset": 0.5},
        ],
        {"order": 1},
    ),
}


def strain(scene, stress):
    """Return the strain tensor under a stress."""
    rock = elastic_rock(scene.rock)
    normal = np.array([[1, 0], [0, 1]]) * 2 * rock.shear_modulus + rock.lame
    xx, yy = np.linalg.solve(normal, stress[:2])
    xy = stress[2] / (2 * rock.shear_modulus)
    return np.array([[xx, xy], [xy, yy]])


def jumps_of(found, scene, stress):
    """Return the displacement of each cell's block less that of uniform strain [blocks, 2], where
    every contact has the jump of its traction, and one of block 0 is none."""
    contacts, n = found.partition.contacts, of_all(found.partition.blocks, found.across, "normal")
    tensor = np.array([[stress[0], stress[2]], [stress[2], stress[1]]])
    traction = n @ tensor
    normal = (traction * n).sum(axis=1)[:, None] * n
    sets = [scene.joint_sets[k] for k in contacts.joint_set]
    k_n, k_s = (
        np.array([[getattr(s, f"{k}_stiffness")] for s in sets]) for k in ("normal", "shear")
    )
    jump = normal / k_n + (traction - normal) / k_s
    moved = np.full((found.partition.count, 2), np.nan)
    moved[0] = 0.0
    while np.isnan(moved).any():
        for (i, j), by in zip(contacts.blocks, jump, strict=True):
            if not np.isnan(moved[i, 0]):
                moved[j] = moved[i] + by
            elif not np.isnan(moved[j, 0]):
                moved[i] = moved[j] - by
    return moved


def on_freedoms(body, values):
    """Return the vector of values [nodes, 2]."""
    found = np.zeros(body.mass.size)
    found[body.freedom(np.arange(len(values))[:, None], np.arange(2))] = values
    return found


@pytest.mark.parametrize("name", MESHES)
def test_a_uniform_stress_is_exact_through_joints_at_any_angle(name, meshed, rock_mass):
    # Rock strains uniformly, every joint has the jump t / K: no force is left but at the boundary.
    joints, numerics = MESHES[name]
    scene, found = rock_mass(joints, numerics), meshed(*joints, continuum=numerics)
    body = found.body
    block = np.empty(len(body.x), dtype=int)
    block[body.cells] = found.block[:, None]
    applied = UPRIGHT if name == "brickwork" else STRESS
    moved = body.x @ strain(scene, applied) + jumps_of(found, scene, applied)[block]
    u = on_freedoms(body, moved)
    stiffness, _ = operators(found)
    force = (stiffness @ u)[body.freedom(np.arange(len(body.x))[:, None], np.arange(2))]
    low, high = body.x.min(axis=0), body.x.max(axis=0)
    inside = ((body.x > low + 1e-9) & (body.x < high - 1e-9)).all(axis=1)
    size = np.abs(force).max()
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(stiffness.data).max() * np.abs(u).max()
    assert size > 1e5


@pytest.mark.parametrize("name", MESHES)
def test_a_rigid_motion_meets_no_force(name, meshed):
    joints, numerics = MESHES[name]
    found = meshed(*joints, continuum=numerics)
    body, (stiffness, _) = found.body, operators(found)
    turned = body.x @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    for motion in (np.ones_like(body.x) * [1.0, -2.0], turned):
        force = stiffness @ on_freedoms(body, motion)
        assert np.abs(force).max() < 1e-13 * np.abs(stiffness.data).max() * np.abs(motion).max() * 4


@pytest.mark.parametrize(
    "cell, order",
    [
        ("quadrilateral", 1),
        ("quadrilateral", 2),
        ("quadrilateral", 3),
        ("quadrilateral", 4),
        ("triangle", 1),
        ("triangle", 2),
    ],
)
def test_displacements_converge_at_one_more_than_the_order(cell, order, meshed, rock_mass):
    # u = (sin 0.5 x cos 0.4 y, sin 0.3 x sin 0.6 y) on blocks that no edge of which is parallel;
    # its body force and its values on the boundary are given. The L2 error falls as h^(order + 1),
    # with h the root of the mean area of cells.
    from scipy.sparse.linalg import spsolve

    errors, cells = [], []
    for size in (1.5, 0.75):
        joints = [{"dip": 15, "through": [3, 3], "normal_stiffness": 1e10}]
        numerics = {"cell": cell, "order": order, "size": size}
        found = meshed(
            *joints, continuum=numerics, domain={"outline": [[0, 0], [6, 0.5], [6.5, 6], [-0.5, 5]]}
        )
        body = found.body
        stiffness, _ = operators(found)
        # The field is continuous: a joint without a jump carries nothing, so rock alone is loaded.
        at, x, volume = quadrature_in(body, np.arange(len(body.cells)), 2 * order + 4)
        load = np.zeros(body.mass.size)
        force = -divergence(elastic_rock(rock_mass().rock), x) * volume[:, None]
        nodes = body.cells[at.cell]
        for c in range(2):
            np.add.at(load, body.freedom(nodes, c), at.basis * force[:, c : c + 1])
        add_tractions(found, load, elastic_rock(rock_mass().rock))
        u = on_freedoms(body, displacement(body.x))
        free = np.zeros(body.mass.size, dtype=bool)
        free[body.freedom(np.arange(len(body.x))[:, None], np.arange(2))] = True
        free[held_nodes(body)] = False
        rest = load - stiffness @ u
        correction = np.zeros_like(u)
        correction[free] = spsolve(stiffness[free][:, free].tocsc(), rest[free])
        off = correction[body.freedom(nodes[:, :, None], np.arange(2))]
        exact = displacement(body.x)[nodes]
        found_at = np.einsum("nk,nkc->nc", at.basis, off + exact)
        cells.append(len(body.cells))
        errors.append(np.sqrt((((found_at - displacement(x)) ** 2).sum(axis=1) * volume).sum()))
    rate = np.log(errors[0] / errors[1]) / np.log(np.sqrt(cells[1] / cells[0]))
    assert rate > order + 0.85


def displacement(x):
    """Return the manufactured displacement at points [n, 2]."""
    a, b = x.T
    return np.stack([np.sin(0.5 * a) * np.cos(0.4 * b), np.sin(0.3 * a) * np.sin(0.6 * b)], axis=1)


def gradient(x):
    """Return its gradient [n, i, j]."""
    a, b = x.T
    return np.moveaxis(
        np.array(
            [
                [0.5 * np.cos(0.5 * a) * np.cos(0.4 * b), -0.4 * np.sin(0.5 * a) * np.sin(0.4 * b)],
                [0.3 * np.cos(0.3 * a) * np.sin(0.6 * b), 0.6 * np.sin(0.3 * a) * np.cos(0.6 * b)],
            ]
        ),
        2,
        0,
    )


def stress(rock, x):
    """Return its stress [n, 2, 2], Pa."""
    g = gradient(x)
    trace = np.trace(g, axis1=1, axis2=2)[:, None, None] * np.eye(2)
    return rock.lame * trace + rock.shear_modulus * (g + g.swapaxes(1, 2))


def divergence(rock, x, h=1e-4):
    """Return the divergence of its stress [n, 2], by central differences of the exact stress."""
    steps = h * np.eye(2)
    return sum(
        (stress(rock, x + s) - stress(rock, x - s))[:, :, k] for k, s in enumerate(steps)
    ) / (2 * h)


def held_nodes(body):
    """Return the freedoms of the nodes on the boundary."""
    from jointwave.continuum.plane.sides import points_on

    nodes = np.unique(points_on(body, list(body.mesh.sides)).node)
    return body.freedom(nodes[:, None], np.arange(2)).ravel()


def add_tractions(found, load, rock):
    """Add what the rock's stress pulls at both faces of the joint, which its springs do not."""
    from jointwave.continuum.space.evaluation import places_in
    from jointwave.continuum.space.interface import facet_points

    body = found.body
    joints = body.mesh.joints
    points = facet_points(body, joints.corners, 2 * body.order + 4)
    n = of_all(found.partition.blocks, found.across, "normal")[joints.joint[points.facet]]
    pull = np.einsum("nij,nj->ni", stress(rock, points.x), n) * points.weight[:, None]
    for cells, sign in ((joints.left, 1.0), (joints.right, -1.0)):
        cell = cells[points.facet]
        basis = places_in(body, cell, points.x).basis
        for c in range(2):
            freedom = body.freedom(body.cells[cell], c)
            np.add.at(load, freedom, sign * basis * pull[:, c : c + 1])
