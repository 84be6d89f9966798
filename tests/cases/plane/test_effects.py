"""Effects of rock masses: those of the scene, by the same names as in pillars."""

import pytest

from jointwave.cases.effects import active_effects, effects

ALWAYS = ["incident waves", "quiet sides", "energy ledger"]
STILL = {"waves": [], "boundaries__bottom": "fixed"}
BASE = {
    "kind": "base",
    "side": "bottom",
    "direction": [1.0, 0.0],
    "quantity": "velocity",
    "shape": "step",
    "amplitude": 1.0,
}


def test_a_plain_scene_calls_for_its_sides_its_waves_and_its_ledger(mass):
    assert active_effects(mass()) == ALWAYS


@pytest.mark.parametrize(
    ("changes", "effect"),
    [
        ({"joint_sets__0__damping_ratio": 0.02}, "dashpots"),
        ({"damping__rayleigh": {"frequencies": [10, 200], "ratios": [0.02, 0.02]}}, "dashpots"),
        ({"joint_sets__0__tension": False}, "no tension"),
        ({"joint_sets__0__maximum_closure": 1e-3}, "closure"),
        ({"joint_sets__0__friction_angle": 30.0}, "slip"),
        ({"joint_sets__0__cohesion": 1e5}, "slip"),
        (
            {
                "joint_sets__0__friction_angle": 30.0,
                "joint_sets__0__dynamic_friction_angle": 20.0,
                "joint_sets__0__weakening_distance": 1e-3,
            },
            "weakening",
        ),
        (
            {
                "joint_sets__0__friction_angle": 30.0,
                "joint_sets__0__dilation_angle": 5.0,
                "joint_sets__0__dilation_distance": 1e-2,
            },
            "dilation",
        ),
        (
            {"joint_sets__0__tensile_strength": 1e5, "joint_sets__0__fracture_energy": 10.0},
            "softening",
        ),
        ({"record__fields": 1e-3}, "field output"),
        ({"damping__mass_proportional": 1.0}, "mass damping"),
        ({"damping__local": 0.8}, "local damping"),
        ({"gravity": {"static": False}}, "gravity"),
        ({"prestress": {"xx": 1e6, "yy": 2e6}}, "prestress"),
        ({"boundaries__top": "fixed"}, "fixed sides"),
        ({"boundaries__left": "periodic", "boundaries__right": "periodic"}, "periodic sides"),
        ({**STILL, "loads": [BASE]}, "shaken base"),
    ],
)
def test_a_key_adds_its_effect_and_says_where_it_is(mass, changes, effect):
    scene = mass(**changes)
    assert effect in active_effects(scene) and effect not in active_effects(mass())
    (found,) = (one for one in effects(scene) if one.name == effect)
    assert found.active and found.reason


def test_the_ledger_can_be_left_out(mass):
    assert "energy ledger" not in active_effects(mass(record__energy=False))


def test_an_effect_of_joints_names_its_sets(mass):
    (slip,) = (x for x in effects(mass(joint_sets__0__cohesion=0.0)) if x.name == "slip")
    assert slip.reason == "friction_angle or cohesion is given: joint"
