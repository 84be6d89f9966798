"""The energy ledger closes: nothing appears, nothing is lost."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.results.dataset import energy_residual

DOWN = {"direction": [0.6, 0.8, 0.0]}
SOFT = [{"y": 3.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
SHAKEN = {
    "shape": "sine",
    "amplitude": 0.1,
    "period": 0.01,
    "quantity": "velocity",
    "direction": [0.48, 0.6, -0.64],
}
SLIP = {"friction_angle": 20.0, "cohesion": 1e4}
LINEAR = {
    "free": {},
    "large step": {"numerics__dem__step_fraction": 0.9},
    "quiet, matched, dashpots": {
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
    "soft layer, mass damping": {
        "soft_layers": SOFT,
        "ends": {"start": "matched", "end": "quiet"},
        "joints__damping_ratio": 0.02,
        "damping__mass_proportional": 50.0,
    },
    "shaken base": {
        "ends": {"start": "fixed", "end": "matched"},
        "load": SHAKEN,
        "joints__damping_ratio": 0.05,
    },
    "all": {
        "ends": {"start": "quiet", "end": "fixed"},
        "soft_layers": SOFT,
        "joints__damping_ratio": 0.05,
        "damping__mass_proportional": 30.0,
        "gravity": {**DOWN, "static": False},
        "prestress": {"normal": 1e5},
    },
    "static gravity": {
        "ends__end": "fixed",
        "joints__damping_ratio": 0.05,
        "gravity": DOWN,
    },
    "local damping": {"damping__local": 0.3},
    "slip": {"joints": SLIP},
    "slip, dashpots, prestress": {
        "joints": {**SLIP, "damping_ratio": 0.05},
        "prestress": {"normal": 1e5},
        "ends": {"start": "quiet", "end": "matched"},
    },
}


@pytest.mark.parametrize("changes", LINEAR.values(), ids=LINEAR)
def test_ledger_closes_to_round_off(row, changes):
    """Below 1e-10 of the work, in the form of the energy that leapfrog conserves at any step.

    Friction books the mean of the spring force before and after the step, which closes as well.
    """
    result = dem.simulate(row(**changes))
    assert energy_residual(result) < 1e-10
    for term in ("viscous", "friction"):
        if term in result.term:
            never_falls(result.energy.sel(term=term).values)


def never_falls(energy):
    assert energy[-1] >= 0 and np.diff(energy).min() >= -1e-12 * np.abs(energy).max()
