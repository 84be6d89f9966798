"""Paying only for what a scene calls for, proved without a clock."""

import numba
import numpy as np
import pytest

from jointwave import dem
from jointwave.dem.axial.build import build
from jointwave.dem.axial.leapfrog import arguments, loop_for
from jointwave.dem.axial.samples import buffers

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


SOFTENING = {"joints__tensile_strength": 1e6, "joints__fracture_energy": 500.0}
SHAKEN = {"load": {"shape": "step", "amplitude": 1.0, "quantity": "velocity"}}
ADDED = {
    "dashpots": ("fmul", {"joints__damping_ratio": 0.02}),
    "no tension": ("fcmp", {"joints__tension": False}),
    "softening": ("fdiv", SOFTENING),
    "held start": ("fdiv", {"ends__start": "matched"}),
    "held end": ("fdiv", {"ends__end": "quiet"}),
    "mass damping": ("fmul", {"damping__mass_proportional": 10.0}),
    "local damping": ("fcmp", {"damping__local": 0.5}),
    "gravity": ("fadd", {"gravity": {"direction": [0, 1, 0], "static": False}}),
    "ledger": ("fadd", {"record__energy": True}),
}


@pytest.fixture
def counted(pillar, instructions, monkeypatch):
    """Return a function that counts one kind of instruction in the time loop of a chain."""
    monkeypatch.setattr(numba.config, "LOOP_VECTORIZE", 0)

    def count(kind, **changes):
        model, state, _, _ = build(pillar(**{"record__energy": False, **changes}))
        loop = loop_for(model.effects._replace(ledger=state.work is not None))
        given = arguments(model, state, buffers(model, state, 1), None)
        return instructions(loop, (given, 0, 1, 0, 1), kind)

    return count


@pytest.mark.parametrize(("kind", "changes"), ADDED.values(), ids=ADDED)
def test_each_effect_adds_instructions(counted, kind, changes):
    """So a chain without it has none of them."""
    assert counted(kind) < counted(kind, **changes)


def test_a_shaken_base_adds_instructions(counted):
    """To those of a fixed start: a quotient."""
    still = {"ends__start": "fixed", "load": {"shape": "step", "amplitude": 0.0}}
    assert counted("fdiv", **still) < counted("fdiv", **(still | SHAKEN))


@pytest.mark.parametrize(
    "nothing",
    [
        {"joints__tension": True},
        {"damping__local": 0.0, "damping__mass_proportional": 0.0},
        {"ends__end": "free"},
    ],
    ids=lambda keys: " ".join(keys),
)
def test_a_key_that_calls_for_nothing_is_not_compiled(counted, pillar, nothing):
    """The loop is that of a chain without the key, to the last instruction."""
    assert build(pillar(**nothing))[0].effects == build(pillar())[0].effects
    for kind in ("fadd", "fmul", "fdiv", "fcmp", "load", "call", "phi"):
        assert counted(kind, **nothing) == counted(kind)
