"""Runs of scenes by dolfinx bodies: interrupted and diverging."""

import numpy as np
import pytest

from jointwave.cases.errors import InterruptedRun, StoppedError
from jointwave.continuum.run import simulate

JOINT = {"dip": 30.0, "through": [3.0, 2.0], "friction_angle": 30.0}
ROCK = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2}
LOAD = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}


def shaken(rock_mass, interval=2e-5, rock=ROCK, **continuum):
    """Return a scene that slips, on a fixed base beside quiet sides."""
    return rock_mass(
        JOINT,
        rock=rock,
        continuum={"steps_per_period": 50, **continuum},
        loads=[LOAD],
        boundaries={"bottom": "fixed", "left": "quiet", "right": "quiet"},
        record={"points": [[2.0, 3.0]], "joints": [[3.0, 2.0]], "interval": interval},
    )


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_an_interrupted_run_goes_on_to_the_same_result(rock_mass, keeper_at, scheme):
    scene = shaken(rock_mass, rock=ROCK | {"quality_factor": 10.0}, scheme=scheme)
    keeper = keeper_at(40)
    whole = simulate(scene)
    assert whole.attrs["scheme"] == scheme
    assert np.abs(whole["slip"]).max() > 1e-6
    with pytest.raises(InterruptedRun):
        simulate(scene, keeper=keeper)
    found = simulate(scene, keeper=keeper)
    for name in ("velocity", "traction", "slip", "energy"):
        np.testing.assert_array_equal(found[name], whole[name], err_msg=name)


def test_a_run_above_the_critical_step_stops_with_what_it_has(rock_mass):
    scene = shaken(rock_mass, 5e-5, scheme="explicit", step_fraction=1.3, allow_unstable=True)
    with pytest.raises(StoppedError, match=r"times the critical step .* to at most 0\.9") as seen:
        simulate(scene)
    result = seen.value.result
    assert 1 <= result.sizes["time"] < 41
    assert np.isfinite(result["velocity"]).all()
