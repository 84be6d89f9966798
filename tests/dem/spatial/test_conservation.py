"""A free row keeps its momentum and angular momentum, whatever its joints do."""

import numpy as np
import pytest

from jointwave.cases.loads import load_history
from jointwave.compare.exact.blocks.system import drive_vector

JOINTS = {
    "elastic": {},
    "slip": {"joints": {"friction_angle": 20.0, "cohesion": 1e4}},
    "no tension": {"joints": {"tension": False}},
}


def momenta(row):
    """Return momentum (N s) and angular momentum about the start face's centre (N m s).

    Of small rotations: the lever of a block is its unloaded place.
    """
    p, v = row.p, row.motion[6:]
    y = p.spacing * (np.arange(p.block_count) + 0.5)
    linear = p.block_mass * v[:3].sum(axis=1)
    spin = np.array([p.inertia_across, p.inertia_along, p.inertia_across]) * v[3:].sum(axis=1)
    swing = p.block_mass * np.array([(y * v[2]).sum(), 0.0, -(y * v[0]).sum()])
    return linear, spin + swing


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS)
def test_momenta_are_the_impulse_of_the_load(row, at_rest, joints):
    """Of a step load up to half a step before the last, to 1e-12 of the largest."""
    scene = row(
        **joints,
        load={
            "shape": "step",
            "amplitude": 1e5,
            "direction": [0.48, 0.6, -0.64],
            "at": [0.1, -0.05],
        },
    )
    blocks = at_rest(scene)
    steps = blocks.time.steps
    blocks.take(0, steps)
    push = drive_vector(scene) * load_history(scene).impulse(blocks.time.dt * (steps - 0.5))
    linear, angular = momenta(blocks)
    assert np.abs(linear - push[:3]).max() < 1e-12 * np.abs(push[:3]).max()
    assert np.abs(angular - push[3:]).max() < 1e-12 * np.abs(push[3:]).max()


def test_a_pair_spins_on_without_a_force(row, at_rest):
    """Two blocks that turn as one about x, y and z: no joint strains, no velocity changes."""
    scene = row(pillar__length=1.0, load__amplitude=0.0, record={"stress": [0.5]})
    blocks = at_rest(scene)
    omega, y = np.array([0.3, -0.2, 0.5]), np.array([-0.25, 0.25])
    velocity = np.array([-omega[2] * y, 0 * y, omega[0] * y, *np.outer(omega, [1, 1])])
    blocks.put(np.concatenate([0 * velocity, velocity]))
    blocks.take(0, 1000)
    assert np.abs(blocks.motion[6:] - velocity).max() < 1e-12
    assert np.abs(blocks.motion[:6] - 1000 * blocks.time.dt * velocity).max() < 1e-12
