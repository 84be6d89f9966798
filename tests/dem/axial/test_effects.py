"""What is on but idle changes nothing."""

import numpy as np
import pytest

from jointwave import dem

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
