"""Manufactured static states with a joint in them, at the rate of the order."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from tests.continuum.bodies import LAME, SHEAR, springs

WAVES = np.array([[0.7, 0.4, -0.5], [-0.3, 0.8, 0.4], [0.5, -0.6, 0.3]])
JOINTS = {2: [{"dip": 30.0, "through": [3.0, 2.0]}], 3: [{"dip": 0.0, "through": [3.0, 2.0, 2.5]}]}
UPRIGHT = [{"dip": 90.0, "through": [3.0, 2.0]}]
OBLIQUE = [{"dip": 40.0, "dip_direction": 120.0, "through": [3.0, 2.0, 2.5]}]


def motion(x):
    """Return u_i = sin(w_i . x) [n, d], its gradient [n, d, d] and stress, and the body force."""
    w = WAVES[: x.shape[1], : x.shape[1]]
    u, slope = np.sin(x @ w.T), np.cos(x @ w.T)[..., None] * w
    trace, one = np.trace(slope, axis1=1, axis2=2), np.eye(len(w))
    stress = LAME * trace[:, None, None] * one + SHEAR * (slope + slope.swapaxes(1, 2))
    # div sigma = (lambda + mu) grad div u + mu laplace u, of sin: its second derivatives are -w w u
    grad_div = -(u[..., None] * np.diag(w)[:, None] * w).sum(axis=1)
    return u, stress, -(LAME + SHEAR) * grad_div + SHEAR * u * (w**2).sum(axis=1)


def error(body):
    """Return the relative error of the static state under the force of that motion, in the mass."""
    (exact, _, force), dim = motion(body.x), body.components
    joints = body.joints
    _, stress, _ = motion(joints.place)
    traction = -np.einsum("pij,pjk,pk->pi", joints.frame, stress, joints.frame[:, 0])
    load = body.mass * force.ravel() / 2600.0
    load += joints.matrix.T @ (joints.weight[:, None] * traction).ravel()
    K, given = body.stiffness + springs(body), np.zeros(len(body.x), bool)
    for side in body.sides.values():
        given[side.node] = True
    fixed, free = (np.flatnonzero(np.repeat(one, dim)) for one in (given, ~given))
    u = exact.ravel().copy()
    u[free] = spsolve(K[free][:, free].tocsc(), load[free] - K[free][:, fixed] @ u[fixed])
    away = (u - exact.ravel()) ** 2 @ body.mass
    return np.sqrt(away / (exact.ravel() ** 2 @ body.mass))


@pytest.mark.parametrize(
    ("dim", "joints", "order", "size"),
    [
        *((2, UPRIGHT, order, 1.0 * order**0.5) for order in (1, 2, 3, 4)),
        (2, JOINTS[2], 1, 0.6),
        (3, JOINTS[3], 1, 1.0),
        (3, JOINTS[3], 2, 2.0),
        (3, OBLIQUE, 1, 1.0),
        (2, JOINTS[2], 2, 1.0),
        (3, OBLIQUE, 2, 2.0),
    ],
)
def test_error_falls_with_the_order_plus_one(made, dim, joints, order, size):
    """By the mean distance of nodes: gmsh's meshes are not halved with the size asked for."""
    bodies = [
        made(*joints, dim=dim, continuum={"order": order, "size": h}).body for h in (size, size / 2)
    ]
    coarse, fine = map(error, bodies)
    finer = (len(bodies[1].x) / len(bodies[0].x)) ** (1 / dim)
    assert fine < 0.02
    assert np.log(coarse / fine) / np.log(finer) > order + 1 - 0.25
