"""A small scene, springs of joints, uniform stress on the sides of a body, blows on a pillar."""

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.space.model import Body
from tests.rocks import rock

STIFFNESS = 2e10, 8e9  # of joints along the normal and in shear, Pa/m
LAME, SHEAR = 5e10 * 0.2 / (1.2 * 0.6), 5e10 / 2.4  # of the rock, Pa

#: On top of a rock mass, and on a pillar.
PUSH = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}
BLOW = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}


def rock_mass(*joints, dim=2, continuum=None, **tables) -> RockMass:
    """Return a scene in 6 m x 4 m, or 6 m x 4 m x 5 m, of rock."""
    law = dict(zip(("normal_stiffness", "shear_stiffness"), STIFFNESS, strict=True))
    own: dict[str, Any] = {
        "time": {"duration": 2e-3},
        "record": {"points": [[2.0, 1.5, 1.0][:dim]]},
        "numerics": {"continuum": {"size": 1.5, "order": 1, **(continuum or {})}},
    }
    return rock([6.0, 4.0, 5.0][:dim], joints, law, **own | tables)


def oblique(dim: int) -> list[float]:
    """Return a direction, in the plane or in space; along the bar."""
    return {1: [0.0, 1.0, 0.0], 2: [0.6, 0.8, 0.0], 3: [0.48, 0.6, -0.64]}[dim]


def blow(dim: int) -> dict[str, Any]:
    """Return an oblique eccentric load; that of a bar is axial."""
    at = {1: [0.0, 0.0], 2: [0.1, 0.0], 3: [0.1, -0.05]}[dim]
    return {**BLOW, "direction": oblique(dim), "at": at}


def springs(body: Body) -> csr_matrix:
    """Return the stiffness of the joints, B^T W k B, N/m."""
    joints = body.joints
    assert joints is not None
    k = [STIFFNESS[0], *[STIFFNESS[1]] * (body.components - 1)]
    weight = np.repeat(joints.weight, body.components) * np.tile(k, len(joints.weight))
    jumps = joints.matrix(body.mass.size)
    return csr_matrix(jumps.T @ diags(weight) @ jumps)


def pushed(body: Body, stress: np.ndarray) -> np.ndarray:
    """Return the forces of a uniform stress [d, d], tension positive, on all sides."""
    force = np.zeros((len(body.x), body.components))
    for side in body.sides.values():
        np.add.at(force, side.node, side.weight[:, None] * (side.normal @ stress))
    return force.ravel()
