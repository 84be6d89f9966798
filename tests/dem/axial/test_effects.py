"""Paying only for what a scene calls for, proved without a clock."""

import numpy as np
import pytest

import dem
from cases.material.calibrate import calibrate
from cases.sampling import Clock
from dem.axial.model import build, build_model
from dem.axial.motion import advanced
from dem.axial.state import state_at_rest
from dem.axial.step import joint_force, march
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
        {"joints__tensile_strength": 1e12, "joints__fracture_energy": 1e18},
        {"soft_layers": [{"y": 20.0, "tensile_strength": 1e12, "fracture_energy": 1e18}]},
        {"gravity": {"direction": [0, 1, 0], "acceleration": 0.0, "static": False}},
        {"prestress": {"normal": 0.0}},
    ],
    ids=[
        "dashpots of zero",
        "tension never asked",
        "both",
        "one idle dashpot",
        "one cut",
        "ledger",
        "strength never reached",
        "one joint's strength never reached",
        "weightless",
        "prestress of zero",
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
        state = state_at_rest(model.chain, p.block_count, False)
        march(model, state, 0, clock.steps)
        ends.append(state.u)
    assert (ends[0] == ends[1]).all()


def test_base_that_stands_is_a_wall(pillar):
    """A base shaken by nothing changes no bit against the fixed start it moves."""
    standing = {"ends__start": "fixed", "gravity": {"direction": [0, 1, 0]}}
    still = {"shape": "step", "amplitude": 0.0}
    wall = dem.simulate(pillar(load=still, **standing))
    base = dem.simulate(pillar(load={**still, "quantity": "velocity"}, **standing))
    assert (waveforms(wall) == waveforms(base)).all()


def test_idle_damping_of_blocks_changes_no_bit(pillar):
    """Keeping all of a velocity and braking none of its gain is no damping."""
    scene = pillar(**COMPRESSION)
    p, clock = calibrate(scene), Clock(1e-5, 1, 2001)
    model, u = build_model(scene, p, clock), []
    for chain in (model.chain, model.chain._replace(keep=1.0, local=0.0)):
        state = state_at_rest(chain, p.block_count, True)
        march(model._replace(chain=chain), state, 0, clock.steps)
        u.append(state.u)
    assert (u[0] == u[1]).all()


def test_absent_effects_leave_no_array(pillar):
    """A plain chain holds two numbers a block and the load, nothing else."""
    model, state, _, _ = build(pillar(record__energy=False))
    chain = model.chain
    assert chain.law == Law(calibrate(pillar()).regular_stiffness)
    assert (chain.start, chain.end, chain.keep, chain.local) == (None,) * 4
    assert (chain.weight, chain.steady, model.base) == (None,) * 3
    assert state[2:] == (None,) * 6


@pytest.mark.parametrize(
    ("damping", "kept"),
    [
        ({}, (None, None, None)),
        ({"joints__damping_ratio": 0.02}, (100, None, 99)),
        ({"damping__mass_proportional": 10.0}, (100, 100, None)),
        ({"damping__local": 0.5}, (100, 100, None)),
    ],
)
def test_the_ledger_keeps_what_damping_calls_for(pillar, damping, kept):
    _, state, _, _ = build(pillar(**damping))
    ledger = state.ledger
    rows = ledger.viscous, ledger.behind, ledger.dashpots
    assert tuple(None if row is None else row.size for row in rows) == kept


SOFTENING = {"joints__tensile_strength": 1e6, "joints__fracture_energy": 500.0}


def test_absent_effects_leave_no_instruction_in_a_joint(pillar, instructions):
    """One product for the traction and one for the force; each effect adds to what is there."""

    def count(kind, **changes):
        model, state, _, _ = build(pillar(**{"record__energy": False, **changes}))
        memory = state.u, state.v, state.gap_rate, state.opening, state.broke, state.ledger
        return instructions(joint_force, (model.chain, *memory, 0, 0), kind)

    plain = {kind: count(kind) for kind in ("fmul", "fadd", "fdiv", "fcmp")}
    assert plain["fadd"] == plain["fdiv"] == plain["fcmp"] == 0
    assert plain["fmul"] < count("fmul", joints__damping_ratio=0.02)
    assert count("fcmp", joints__tension=False) > 0
    assert count("fdiv", **SOFTENING) > 0
    assert count("fadd", joints__damping_ratio=0.02, record__energy=True) > 0
    assert plain["fmul"] == count("fmul", damping__local=0.5, prestress={"normal": 1e6})


def test_absent_effects_leave_no_instruction_in_a_block(pillar, instructions):
    """One product and one sum for the velocity; each damping adds to them, the ledger nothing."""

    def count(kind, **changes):
        model, state, _, _ = build(pillar(**{"record__energy": False, **changes}))
        return instructions(advanced, (model.chain, state.ledger, 1, 1.0, 1.0), kind)

    plain = {kind: count(kind) for kind in ("fmul", "fadd")}
    assert count("fcmp") == count("fsub") == 0
    assert plain == {kind: count(kind, record__energy=True) for kind in plain}
    assert plain["fmul"] < count("fmul", damping__mass_proportional=10.0)
    assert count("fcmp", damping__local=0.5) > 0
    assert count("fsub", damping__mass_proportional=10.0, record__energy=True) > 0


def test_absent_effects_leave_no_instruction_in_the_loop(pillar, instructions):
    """No comparison and no quotient in the whole loop of a plain chain."""

    def count(kind, **changes):
        model, state, _, _ = build(pillar(record__energy=False, **changes))
        return instructions(march, (model, state, 0, 1), kind)

    assert count("fcmp") == 0 < count("fcmp", joints__tension=False)
    assert count("fdiv") == 0 < count("fdiv", ends__end="quiet")
