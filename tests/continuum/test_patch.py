"""Uniform stress through joints, and motions that strain nothing.
Orders of convergence are those of manufactured motions, `verification/test_manufactured.py`."""

import numpy as np
import pytest

from jointwave.continuum.space.evaluation import blocks_of_nodes
from tests.continuum.bodies import LAME, SHEAR, STIFFNESS, pushed, springs

STRESS = np.array([[3.0, 1.0, -0.5], [1.0, -2.0, 0.8], [-0.5, 0.8, 1.5]]) * 1e6
PLANE = [[{"dip": dip, "spacing": 1.7}] for dip in (0.0, 17.0, 45.0, -63.0, 90.0)]
CROSSED = [{"dip": 20.0, "spacing": 2.1}, {"dip": -65.0, "spacing": 1.9}]
SPACE = [
    [{"dip": 0.0, "spacing": 1.7}],
    [{"dip": 35.0, "dip_direction": 110.0, "spacing": 2.3}],
    [
        {"dip": 50.0, "dip_direction": 20.0, "spacing": 2.5},
        {"dip": 80.0, "dip_direction": 290.0, "through": [3.0, 2.0, 2.5]},
    ],
]
CASES = [(2, joints, 1) for joints in [*PLANE, CROSSED]]
CASES += [(2, PLANE[0], order) for order in (2, 3, 4)] + [(3, SPACE[0], 2)]
CASES += [(2, CROSSED, 2), (2, PLANE[1], 2), (3, SPACE[1], 2)]  # with bubbles
CASES += [(3, joints, 1) for joints in SPACE]


def stressed(found, stress):
    """Return the displacement under a uniform stress: each block moves by what all joints between
    it and block 0 open and slide."""
    body, contacts, dim = found.body, found.blocks.contacts, len(stress)
    lateral = LAME / (dim * LAME + 2 * SHEAR) * np.trace(stress) * np.eye(dim)
    traction = contacts.normal @ stress
    opening = (traction * contacts.normal).sum(axis=1)[:, None] * contacts.normal
    jump = opening / STIFFNESS[0] + (traction - opening) / STIFFNESS[1]
    rows, number = np.zeros((len(contacts), found.blocks.count)), np.arange(len(contacts))
    rows[number, contacts.blocks[:, 0]], rows[number, contacts.blocks[:, 1]] = -1.0, 1.0
    motion, *_ = np.linalg.lstsq(rows, jump, rcond=None)
    return (body.x @ (stress - lateral) / (2 * SHEAR) + motion[blocks_of_nodes(body)]).ravel()


@pytest.mark.parametrize(("dim", "joints", "order"), CASES)
def test_uniform_stress_is_in_balance_through_joints(made, dim, joints, order):
    found, stress = made(*joints, dim=dim, continuum={"order": order}), STRESS[:dim, :dim]
    u, body = stressed(found, stress), found.body
    assert (found.blocks.contacts.joint_set >= 0).all()
    force = (body.stiffness + springs(body)) @ u - pushed(body, stress)
    assert np.abs(force).max() < 1e-12 * np.abs(body.stiffness).max() * np.abs(u).max()
    jump = body.joints.jumps(u)
    expected = np.einsum("pij,jk,pk->pi", body.joints.frame, stress, body.joints.frame[:, 0])
    ratio = jump * [STIFFNESS[0], *[STIFFNESS[1]] * (dim - 1)] / np.abs(stress).max()
    assert np.allclose(ratio, expected / np.abs(stress).max(), rtol=0, atol=1e-9)


@pytest.mark.parametrize(("dim", "joints", "order"), CASES)
def test_rigid_motions_mass_areas_and_symmetry(made, dim, joints, order):
    found = made(*joints, dim=dim, continuum={"order": order})
    body, blocks, K = found.body, found.blocks, found.body.stiffness
    turn = np.array([[0.0, -1.0, 0.4], [1.0, 0.0, -0.7], [-0.4, 0.7, 0.0]])[:dim, :dim]
    u = (body.x @ turn + np.arange(1, dim + 1)).ravel()
    assert np.abs(K @ u).max() < 1e-13 * np.abs(K).max() * u.max()
    assert np.abs(body.joints.jumps(u)).max() < 1e-13 * u.max()
    assert np.abs(K - K.T).max() < 1e-14 * np.abs(K).max()
    mass = body.mass.reshape(-1, dim)
    assert mass.min() > 0
    assert np.allclose(mass.sum(axis=0), 2600.0 * blocks.volume.sum(), rtol=1e-13)
    first = np.append(body.x, body.x**2 / 2, axis=1)[:, :dim].T @ mass[:, 0]
    assert np.allclose(first, 2600.0 * blocks.volume @ blocks.centroid, rtol=1e-12)
    assert np.isclose(body.joints.weight.sum(), blocks.contacts.area.sum(), rtol=1e-12)
    sides = sum(side.weight.sum() for side in body.sides.values())
    assert np.isclose(sides, blocks.boundary.area.sum(), rtol=1e-12)


def test_brickwork_carries_stress_across_its_beds(made):
    """T-junctions: bricks of offset rows, strained along the normal of the beds alone. What the
    heads pass on to each other, closed as they are, is given."""
    beds = {"name": "beds", "dip": 0.0, "spacing": 1.0}
    heads = {"dip": 90.0, "spacing": 1.5, "ends_at": ["beds"], "offset": 0.5}
    found = made(beds, heads, continuum={"size": 0.6})
    body, joints, strain = found.body, found.body.joints, np.diag([0.0, 2e-5])
    stress = LAME * np.trace(strain) * np.eye(2) + 2 * SHEAR * strain
    row = np.floor(found.blocks.centroid[:, 1])
    motion = row[:, None] * [0.0, stress[1, 1] / STIFFNESS[0]]
    u = (body.x @ strain + motion[blocks_of_nodes(body)]).ravel()
    jump, along = joints.jumps(u), np.abs(joints.frame[:, 0, 0]) > 0.5
    traction = np.zeros_like(jump)
    traction[:, 0] = np.where(along, stress[0, 0], STIFFNESS[0] * jump[:, 0])
    force = body.stiffness @ u - pushed(body, stress)
    force += joints.matrix(u.size).T @ (joints.weight[:, None] * traction).ravel()
    assert along.any() and found.blocks.count > 16
    assert np.abs(force).max() < 1e-12 * np.abs(body.stiffness).max() * np.abs(u).max()
    assert np.abs(jump[along]).max() < 1e-13 * np.abs(u).max()
