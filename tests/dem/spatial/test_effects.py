"""Paying only for what a scene calls for, proved without a clock."""

import numpy as np
import pytest

import dem
from dem.spatial.build import buffers_for
from dem.spatial.layout import LANES, KernelFlags
from dem.spatial.march import arguments, march_for

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


def test_absent_effects_leave_no_array(row, at_rest):
    """An elastic row of free ends holds its motion and the load, nothing else."""
    blocks = at_rest(row(record__energy=False))
    model, state, form = blocks.model, blocks.state, blocks.model.form
    assert (state.history, state.ends, state.sums) == (None,) * 3
    assert (model.ends, model.load.base) == (None,) * 2
    assert buffers_for(model, 1).ledgers is None and blocks.samples.energy is None
    assert form == KernelFlags(parts=form.parts, turns=True, **dict.fromkeys(ABSENT, False))
    assert [name for name, there in form.parts._asdict().items() if there] == ["shear"]
    assert form.motion_rows == 12 and len(model.table) == 1


def test_blocks_that_do_not_turn_have_three_freedoms(row, at_rest):
    """No rotation, one contact point, six rows of motion."""
    still = at_rest(row(motion__rotation="none", load__at=[0.0, 0.0], record__energy=False))
    assert still.model.form.motion_rows == 6 and not still.model.form.turns
    assert still.model.points.shape == (3, 1)


def test_only_what_slides_or_softens_is_remembered(row, at_rest):
    """A point has two slides, an opening with softening, a cohesion that slip may weaken, and the
    path that weakens its friction."""
    slip = {"friction_angle": 20.0, "cohesion": 1e4}
    soft = {"tensile_strength": 1e5, "fracture_energy": 50.0}

    def kept(**joints):
        blocks = at_rest(row(joints=joints))
        form, history = blocks.model.form, blocks.state.history
        rows = form.rate_rows + form.point_rows * blocks.model.points.shape[1]
        assert rows == (0 if history is None else history.shape[1] // LANES)
        return form.rate_rows, form.point_rows

    assert kept() == (0, 0)
    assert kept(damping_ratio=0.1) == (6, 0)
    assert kept(**slip) == (0, 2)
    assert kept(**slip, **soft) == (0, 3)
    assert kept(**slip, residual_cohesion=1e3, damping_ratio=0.1) == (6, 3)
    weakens = {"dynamic_friction_angle": 10.0, "weakening_distance": 1e-3}
    assert kept(**slip, **weakens, residual_cohesion=1e3) == (0, 4)
    dilates = {"dilation_angle": 5.0, "dilation_distance": 1e-2}
    assert kept(**slip, **dilates) == (0, 3) and kept(**slip, **weakens, **dilates) == (0, 3)
    assert kept(**slip, contact_points=3) == (0, 2)


def test_absent_effects_leave_no_instruction(row, at_rest, instructions):
    """No comparison, division or root in an elastic row; friction brings all three. Both work on
    several blocks at once."""

    def count(**changes):
        blocks = at_rest(row(record__energy=False, **changes))
        buffers = buffers_for(blocks.model, 1)
        progress = np.zeros(2, dtype=np.int64)
        given = arguments(blocks.model, blocks.state, buffers, blocks.samples, progress)
        kernel, given = march_for(blocks.model.form), (given, 0, 0, 1)
        return [
            instructions(kernel, given, kind)
            for kind in ("fcmp", "fdiv", SQRT, "fmul", "fmul" + SEVERAL, "fdiv" + SEVERAL)
        ]

    elastic, slip = count(), count(joints={"friction_angle": 20.0})
    assert elastic[:3] == [0, 0, 0]
    assert min(slip[:3]) > 0 and slip[3] > elastic[3]
    assert elastic[4] > 0 and min(slip[4:]) > 0
    assert count(motion__rotation="none", load__at=[0.0, 0.0])[3] < elastic[3]


@pytest.mark.parametrize("blocks", [64, 65, 129])
def test_a_tile_without_a_joint_has_a_law_all_the_same(row, at_rest, blocks):
    """The last block of 64 n + 1 has a tile to itself: tables and cohesions cover it too."""
    layer = {"y": 2.0, "cohesion": 2e5}
    joints = {"friction_angle": 20.0, "cohesion": 1e5, "residual_cohesion": 0.0}
    scene = row(pillar__length=0.5 * blocks, joints=joints, soft_layers=[layer])
    built = at_rest(scene)
    assert len(built.model.table) == len(built.state.motion) == -(-blocks // 64)
    kept = built.state.history.reshape(len(built.state.history), -1, 64)
    kept = kept[:, built.model.form.cohesions]
    assert kept.shape[1] == 4
    of_joints = kept.transpose(1, 0, 2).reshape(4, -1)[:, : blocks - 1]
    expected = np.where(np.arange(blocks - 1) == 3, 2e5, 1e5)
    assert (of_joints == expected).all()
