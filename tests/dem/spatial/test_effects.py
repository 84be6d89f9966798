"""Paying only for what a scene calls for, proved without a clock."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.dem.spatial.build import buffers_for, samples_for, state_at_rest
from jointwave.dem.spatial.march import arguments, march_for
from jointwave.dem.spatial.simulate import prepare

FIELDS = ("stress", "shear", "velocity", "displacement", "rotation")
ABSENT = ("points", "finite", "mass_damping", "local_damping", "gravity", "base", "start", "end")
ABSENT += ("ledger", "relaxed")
SEVERAL = r" <\d+ x double>"  # of several blocks at once
SQRT = r"(?:tail )?call \S+ @llvm\.sqrt\S*"


def waveforms(result):
    """Return the samples of every field."""
    return {name: result[name].values for name in FIELDS if name in result}


@pytest.mark.parametrize(
    "idle",
    [
        {"joints__damping_ratio": 0.0},
        {"record__energy": False},
        {"soft_layers": [{"y": 2.0}]},
        {"joints__contact_points": 2, "joints__point_rule": "midpoint"},
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
    with_idle = waveforms(dem.simulate(row(**changes, joints=idle)))
    for name, values in without.items():
        assert np.abs(values - with_idle[name]).max() < 1e-12 * np.abs(values).max()


def test_absent_effects_leave_no_instruction(row, instructions):
    """No comparison, division or root in an elastic row; friction brings all three. Both work on
    several blocks at once."""

    def count(**changes):
        _, model, time, _ = prepare(row(record__energy=False, **changes))
        state, samples = state_at_rest(model), samples_for(model, time.samples + 1)
        progress = np.zeros(2, dtype=np.int64)
        given = arguments(model, state, buffers_for(model, 1), samples, progress)
        kernel, given = march_for(model.form), (given, 0, 0, 1)
        return [
            instructions(kernel, given, kind)
            for kind in ("fcmp", "fdiv", SQRT, "fmul", "fmul" + SEVERAL, "fdiv" + SEVERAL)
        ]

    elastic, slip = count(), count(joints={"friction_angle": 20.0})
    assert elastic[:3] == [0, 0, 0]
    assert min(slip[:3]) > 0 and slip[3] > elastic[3]
    assert elastic[4] > 0 and min(slip[4:]) > 0
    assert count(motion__rotation="none", load__at=[0.0, 0.0])[3] < elastic[3]
