"""Where a pulse that comes back from a free end first pulls the row apart."""

import numpy as np
import pytest

from closed_forms.spall import lattice_spall, spall
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.axial.build import build
from jointwave.dem.axial.leapfrog import march


@pytest.mark.parametrize("strength", [5e5, 6e5, 8e5])  # the wavelet's own tension is 4.5e5
@pytest.mark.parametrize("period", [0.02, 0.03])
def test_first_break_is_a_joint_beside_the_bars(pillar, period, strength):
    """The exact chain names the joint; the homogenised bar's place is within one joint spacing.

    Brittle joints (w_c = 1.001 w_0) and a wavelet of 54 or 80 blocks, so that the dispersion of
    the chain, (k d)^2 / 24 of the way, is below one joint spacing.
    """
    probe = pillar()
    least = strength**2 / (2 * calibrate(probe).regular_stiffness)
    scene = pillar(
        load={"shape": "ricker", "amplitude": 1e6, "period": period},
        joints={"tensile_strength": strength, "fracture_energy": 1.001 * least},
        time__duration=0.12,
    )
    p = calibrate(scene)
    bar = spall(load_history(scene), strength, 50.0, p.bar_speed, 0.12)
    chain = lattice_spall(scene)
    model, state, time, _ = build(scene)
    march(model, state, 0, time.steps)
    broken = np.flatnonzero(state.broke >= 0)
    first = broken[state.broke[broken] == state.broke[broken].min()]  # two can share a step
    distance = 50.0 - p.joint_y[first]
    assert np.abs(distance - chain.distance).min() < 1e-9
    assert np.abs(distance - bar.distance).max() <= p.spacing
