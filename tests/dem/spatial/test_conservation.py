"""A free row keeps its momentum and angular momentum, whatever its joints do."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks.pillar import drive_vector

JOINTS = {
    "elastic": {},
    "slip": {"joints": {"friction_angle": 20.0, "cohesion": 1e4}},
    "no tension": {"joints": {"tension": False}},
}
Y = 0.25 + 0.5 * np.arange(16)  # m, centres of the blocks
BLOW = {"shape": "step", "amplitude": 1e5, "direction": [0.48, 0.6, -0.64], "at": [0.1, -0.05]}


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS)
def test_momenta_are_the_impulse_of_the_load(row, joints):
    """Of a step load, half a step before the last, to 1e-12 of the largest: momentum, and angular
    momentum about the start face's centre. Rotations are small: the lever of a block is its
    unloaded place."""
    record = {"velocity": Y.tolist(), "interval": 1e-5}  # every step
    scene = row(**joints, load=BLOW, record=record, time__duration=0.02)
    p, result = calibrate(scene), dem.simulate(scene)
    assert result.attrs["dt"] == 1e-5
    v, omega = (result[k].values[:, -2:] for k in ("displacement", "rotation"))
    v, omega = (np.diff(x, axis=1)[:, 0] / 1e-5 for x in (v, omega))
    linear = p.block_mass * v.sum(axis=0)
    spin = np.array([p.inertia_across, p.inertia_along, p.inertia_across]) * omega.sum(axis=0)
    swing = p.block_mass * np.array([(Y * v[:, 2]).sum(), 0.0, -(Y * v[:, 0]).sum()])
    time = float(result.time[-1]) - 5e-6
    push = drive_vector(scene) * load_history(scene).impulse(time)
    assert np.abs(linear - push[:3]).max() < 1e-12 * np.abs(push[:3]).max()
    assert np.abs(spin + swing - push[3:]).max() < 1e-12 * np.abs(push[3:]).max()
