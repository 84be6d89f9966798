"""Paying only for what a scene calls for, proved without a clock."""

import numpy as np
import pytest

import dem
from cases.calibrate import calibrate
from cases.sampling import Clock
from dem.model import build, build_model, state_at_rest
from dem.step import march
from joints.laws import Law

COMPRESSION = {"load": {"shape": "step", "amplitude": 1e6}, "time__duration": 0.03}


def waveforms(result):
    """Return every sample of a result in one array."""
    return np.concatenate([result[name].values.ravel() for name in ("stress", "velocity")])


@pytest.mark.parametrize(
    "idle",
    [
        {"joints__damping_ratio": 0.0},
        {"joints__tension": False},
        {"joints__tension": False, "joints__damping_ratio": 0.0},
        {"soft_layers": [{"y": 20.0, "damping_ratio": 0.0}]},
        {"soft_layers": [{"y": 20.0, "tension": False}]},
        {"record__energy": False},
    ],
    ids=[
        "dashpots of zero",
        "tension never asked",
        "both",
        "one idle dashpot",
        "one cut",
        "ledger",
    ],
)
def test_idle_effect_changes_no_bit(pillar, idle):
    """The kernel with an effect on but idle gives the very numbers of the kernel without it."""
    without, with_idle = (
        dem.simulate(pillar(**COMPRESSION)),
        dem.simulate(pillar(**COMPRESSION, **idle)),
    )
    assert without.attrs["dt"] == with_idle.attrs["dt"]
    assert (waveforms(without) == waveforms(with_idle)).all()


def test_idle_quiet_end_changes_no_bit(pillar):
    """A dashpot of zero impedance on the end block is a free end."""
    free, quiet = pillar(), pillar(ends__end="quiet")
    p, clock = calibrate(free), Clock(1e-5, 1, 4001)
    ends = []
    for scene in (free, quiet):
        model = build_model(scene, p, clock)
        if model.chain.end is not None:
            idle = model.chain.end._replace(viscosity=0.0)
            model = model._replace(chain=model.chain._replace(end=idle))
        state = state_at_rest(model, p.block_count, False)
        march(model, state, 0, clock.steps)
        ends.append(state.u)
    assert (ends[0] == ends[1]).all()


def test_absent_effects_leave_no_array(pillar):
    """A plain chain holds two numbers a block and the load, nothing else."""
    model, state, _, _ = build(pillar(record__energy=False))
    assert model.chain.law == Law(calibrate(pillar()).regular_stiffness, None, None)
    assert (state.gap_rate, state.start, state.end, state.ledger) == (None,) * 4
    assert (model.chain.start, model.chain.end) == (None, None)


def test_absent_effects_leave_no_instruction(pillar, instructions):
    """No comparison without no-tension, and each effect adds arithmetic that is else not there."""

    def count(kind, **changes):
        model, state, _, _ = build(pillar(record__energy=False, **changes))
        return instructions(march, (model, state, 0, 1), kind)

    assert count("fcmp") == 0 < count("fcmp", joints__tension=False)
    assert 0 < count("fmul") < count("fmul", joints__damping_ratio=0.02)
    assert count("fdiv") == 0 < count("fdiv", ends__end="quiet")
