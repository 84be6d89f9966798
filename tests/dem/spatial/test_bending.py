"""A column that bends: static deflection and first mode, for every face of contact points."""

import numpy as np
import pytest

from closed_forms import cantilever
from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks.pillar import system_of

FACES = {
    "vertices": ({}, 1.0),
    "2 x 2 midpoint": ({"point_rule": "midpoint"}, 3 / 4),
    "3 x 3 midpoint": ({"contact_points": 3, "point_rule": "midpoint"}, 8 / 9),
    "2 x 2 Gauss": ({"contact_points": 2, "point_rule": "gauss"}, 1.0),
}
ACROSS = {"load": {"shape": "step", "amplitude": 0.0}, "ends__end": "fixed"}
UNLOADED = {"load__direction": [0, 1, 0], "load__at": [0.0, 0.0]}
TOLERANCE = 1e-8


@pytest.mark.parametrize("joints, share", FACES.values(), ids=FACES)
@pytest.mark.parametrize("axis, turn, sign", [(0, 5, 1), (2, 3, -1)], ids="xz")
def test_static_deflection_is_the_explicit_sum(row, joints, share, axis, turn, sign):
    """What is out of balance by 1e-8 W moves no freedom by more than 1e-8 W sum |K^-1|."""
    direction = [0.0, 0.0, 0.0]
    direction[axis] = 1.0
    y = (0.25 + 0.5 * np.arange(16)).tolist()
    scene = row(
        **{**UNLOADED, **ACROSS},
        joints=joints,
        gravity={"direction": direction},
        record={"stress": [], "velocity": y, "interval": 0.01},
    )
    p, result = calibrate(scene), dem.simulate(scene)
    bending = p.regular_stiffness * share * p.side**4 / 12
    weight, shear = 9.81 * p.block_mass, p.regular_shear_stiffness * p.area
    u, theta = cantilever.deflection(16, p.spacing, weight, shear, bending)
    flexibility = np.abs(np.linalg.inv(system_of(scene).stiffness.toarray())).sum(axis=1)
    flexibility = flexibility.reshape(16, 6)[:, [axis, turn]]
    bound = TOLERANCE * 16 * weight * flexibility
    assert (np.abs(result.displacement.values[:, 0, axis] - u) <= bound[:, 0]).all()
    turned = result.rotation.values[:, 0, turn - 3]
    assert (np.abs(turned - sign * theta) <= bound[:, 1]).all()
    assert result.attrs["static_out_of_balance"] <= TOLERANCE
