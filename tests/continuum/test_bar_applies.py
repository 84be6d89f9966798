"""What the bar is not, said in one line before any run."""

import pytest

from continuum.simulate import MODELS, applies

BEYOND = {
    "motion across": ({"load__direction": [0.0, 0.0, 1.0]}, "no motion across its axis"),
    "tensile strength": (
        {"joints__tensile_strength": 1e5, "joints__fracture_energy": 10.0},
        "no tensile strength",
    ),
    "gravity": ({"gravity": {"direction": [0, -1, 0], "static": False}}, "no weight"),
    "prestress": ({"prestress": {"normal": 1e6}}, "no stress before the load"),
    "mass damping": ({"damping": {"mass_proportional": 5.0}}, "strain rate alone"),
    "local damping": ({"damping": {"local": 0.5}}, "strain rate alone"),
    "shaken base": (
        {"ends__start": "fixed", "load__quantity": "velocity"},
        "neither fixed nor shaken",
    ),
}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", BEYOND)
def test_the_bar_says_what_it_is_not(pillar, name, model):
    changes, reason = BEYOND[name]
    assert reason in applies(pillar(**changes), model)


@pytest.mark.parametrize("model", MODELS)
def test_friction_that_nothing_calls_for_is_no_obstacle(pillar, model):
    assert applies(pillar(joints__friction_angle=30.0), model) == ""
