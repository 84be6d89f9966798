"""The energy ledger closes: nothing appears, nothing is lost."""

import pytest

from jointwave import dem
from jointwave.results.dataset import energy_residual

DOWN = {"direction": [0, 1, 0]}
HELD = {"start": "matched", "end": "fixed"}
BASE = {"ends__end": "fixed", "joints__damping_ratio": 0.02}
SEGMENTS = [
    {"y": [5.0, 12.0], "density": 5000.0, "block": 0.25},
    {"y": [30.0, 50.0], "joints": False, "block": 0.4, "intact_modulus": 1e10},
]
SHAKEN = {"shape": "sine", "amplitude": 1.0, "period": 0.01, "quantity": "velocity"}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"ends__end": "quiet"},
        {"ends__end": "matched", "ends__start": "matched"},
        {"ends__end": "fixed"},
        {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}], "joints__damping_ratio": 0.02},
        {"joints__damping_ratio": 0.3},
        {"numerics__dem__step_fraction": 0.9},
        {"damping__mass_proportional": 100.0, "joints__damping_ratio": 0.02},
        {"damping__local": 0.3, "ends__end": "quiet"},
        {"gravity": DOWN, **BASE},
        {"gravity": {**DOWN, "static": False}, **BASE},
        {"segments": SEGMENTS, "joints__damping_ratio": 0.1, "ends": HELD},
        {"segments": SEGMENTS, "damping__mass_proportional": 50.0, "prestress": {"normal": 2e6}},
        {"prestress": {"normal": 2e6}, "ends": {"start": "quiet", "end": "matched"}},
        {
            "load": SHAKEN,
            "ends": {"start": "fixed", "end": "matched"},
            "joints__damping_ratio": 0.1,
        },
        {
            "load": SHAKEN,
            "ends": {"start": "fixed", "end": "matched"},
            "joints__damping_ratio": 0.1,
            "soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}],
            "damping__mass_proportional": 30.0,
            "gravity": DOWN,
            "prestress": {"normal": 2e6},
        },
    ],
    ids=[
        "free",
        "quiet",
        "matched",
        "fixed",
        "soft layer",
        "dashpots",
        "large step",
        "mass damping",
        "local damping",
        "gravity",
        "sudden gravity",
        "segments",
        "damped segments",
        "prestress",
        "shaken base",
        "all",
    ],
)
def test_linear_scenes_close_to_round_off(pillar, changes):
    """Below 1e-10 of the work, in the form of the energy that leapfrog conserves at any step.

    Local damping is not linear in the motion, but books what it takes all the same. Joints are
    damped where those of test_accuracy.py are, whose kernels serve here too.
    """
    assert energy_residual(dem.simulate(pillar(**changes))) < 1e-10


@pytest.mark.parametrize("ratio", [None, 0.02])
def test_no_tension_closes_to_second_order(pillar, ratio):
    """A joint opens between two steps, which costs (k / 2) gap^2 of at most one step's gap."""
    changes = {} if ratio is None else {"joints__damping_ratio": ratio}
    residual = [
        energy_residual(
            dem.simulate(
                pillar(joints__tension=False, numerics__dem__step_fraction=fraction, **changes)
            )
        )
        for fraction in (0.1, 0.05)
    ]
    assert residual[1] < 1e-3
    assert residual[1] < residual[0]
