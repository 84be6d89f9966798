"""What is on but idle changes nothing, or round-off alone."""

import numpy as np
import pytest

from jointwave import dem

FIELDS = ("stress", "shear", "velocity", "displacement", "rotation")


def waveforms(result):
    """Return the samples of every field."""
    return {name: result[name].values for name in FIELDS if name in result}


@pytest.mark.parametrize(
    "idle",
    [
        {"joints__damping_ratio": 0.0},
        {"record__energy": False},
        {"soft_layers": [{"y": 2.0}]},
        {"joints__contact_points": 2},
    ],
    ids=["dashpots of zero", "ledger", "layer like the rock", "points by default"],
)
def test_idle_effect_changes_no_bit(row, idle):
    """The kernel with an effect on but idle gives the very numbers of the kernel without it."""
    without, with_idle = waveforms(dem.simulate(row())), waveforms(dem.simulate(row(**idle)))
    assert all((values == with_idle[name]).all() for name, values in without.items())


@pytest.mark.parametrize(
    "idle, prestress",
    [
        ({"friction_angle": 20.0, "cohesion": 1e9}, None),
        pytest.param({"tension": False}, 5e6, marks=pytest.mark.slow),
    ],
    ids=["friction never reached", "tension never asked"],
)
def test_idle_joint_law_changes_round_off_alone(row, idle, prestress):
    """A joint that may slip or open is summed over its points, one that holds over its section.

    Both sums differ in the last digits, which some thousand steps make 1e-12 of the largest; of
    the prestress where there is one.
    """
    changes = {} if prestress is None else {"prestress": {"normal": prestress}}
    without = waveforms(dem.simulate(row(**changes)))
    with_idle = waveforms(dem.simulate(row(**changes, joints=idle | {"point_rule": "midpoint"})))
    for name, values in without.items():
        assert np.abs(values - with_idle[name]).max() < 1e-12 * np.abs(values).max()
