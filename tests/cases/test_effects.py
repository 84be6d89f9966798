"""The effects of a scene, key by key."""

import pytest

from jointwave.cases.effects import active_effects, effects, is_spatial

ACROSS = {"load.direction": [1.0, 0.0, 0.0]}
DOWN = {"direction": [0, -1, 0], "static": False}
TENSILE = {"joints.tensile_strength": 1e5, "joints.fracture_energy": 10.0}
RAYLEIGH = {"frequencies": [10.0, 20.0], "ratios": [0.02, 0.02]}

CALLS = {
    "dashpots": {"joints.damping_ratio": 0.02},
    "closure": {"joints.maximum_closure": 1e-3},
    "segments": {"segments": [{"y": [10.0, 20.0], "density": 2600.0}]},
    "scatter": {"scatter": {"spacing": 0.2, "seed": 1}},
    "no tension": {"joints.tension": False},
    "joints that differ": {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}]},
    "quiet ends": {"ends.end": "quiet"},
    "matched ends": {"ends.start": "matched"},
    "fixed ends": {"ends.end": "fixed"},
    "energy ledger": {"record.energy": True},
    "field output": {"record.fields": 0.01},
    "spatial motion": ACROSS,
    "softening": TENSILE,
    "mass damping": {"damping": {"mass_proportional": 5.0}},
    "local damping": {"damping": {"local": 0.8}},
    "constant Q": {"rock.quality_factor": 20.0},
    "gravity": {"gravity": DOWN},
    "prestress": {"prestress": {"normal": 1e6}},
}

DILATES = {"dilation_angle": 5.0, "dilation_distance": 1e-2}
WEAKENS = {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3}
RATED = {"direct_effect": 0.01, "evolution_effect": 0.015}
RATED |= {"critical_slip_distance": 1e-4, "reference_rate": 1e-6}
MORE_CALLS = {
    ("spatial motion", "finite rotation"): ACROSS | {"motion.rotation": "finite"},
    ("spatial motion", "slip"): ACROSS | {"joints.friction_angle": 30.0},
    ("spatial motion", "slip", "weakening"): ACROSS
    | {"joints": {"friction_angle": 30.0, **WEAKENS}},
    ("spatial motion", "slip", "dilation"): ACROSS
    | {"joints": {"friction_angle": 30.0, **DILATES}},
    ("spatial motion", "slip", "rate and state"): ACROSS
    | {"joints": {"friction_angle": 30.0, **RATED}},
    ("fixed ends", "shaken base"): {"ends.start": "fixed", "load.quantity": "velocity"},
    ("dashpots", "mass damping"): {"damping": {"rayleigh": RAYLEIGH}},
}

SPATIAL = {
    "the load has a component across the axis": ACROSS,
    "the load is eccentric": {"load.at": [0.0, 0.1]},
    "the load is a couple": {"load.arm": 0.1},
    "gravity has a component across the axis": {
        "gravity": {"direction": [0.6, -0.8, 0.0], "static": False}
    },
}


@pytest.mark.parametrize("name", CALLS)
def test_one_key_calls_for_one_effect(scene_with, name):
    nothing = {"record.energy": False}
    assert active_effects(scene_with(**nothing)) == []
    assert active_effects(scene_with(**nothing | CALLS[name])) == [name]


@pytest.mark.parametrize("names", MORE_CALLS)
def test_effects_that_come_with_others(scene_with, names):
    assert active_effects(scene_with(**{"record.energy": False} | MORE_CALLS[names])) == [*names]


def test_every_effect_is_called_for_above(scene_with):
    called = {*CALLS, *(name for names in MORE_CALLS for name in names)}
    assert {effect.name for effect in effects(scene_with())} == called


@pytest.mark.parametrize("reason", SPATIAL)
def test_what_takes_a_scene_off_its_axis(scene_with, reason):
    scene = scene_with(**SPATIAL[reason])
    assert is_spatial(scene)
    reasons = {effect.name: effect.reason for effect in effects(scene)}
    assert reasons["spatial motion"] == f"{reason}: 6 degrees of freedom"


def test_axial_gravity_and_a_load_against_the_axis_stay_axial(scene_with):
    assert not is_spatial(scene_with(gravity=DOWN, **{"load.direction": [0, -1, 0]}))


def test_blocks_that_do_not_turn_have_three_freedoms(scene_with):
    scene = scene_with(**ACROSS, **{"motion.rotation": "none"})
    reasons = {effect.name: effect.reason for effect in effects(scene)}
    assert reasons["spatial motion"].endswith("3 degrees of freedom")


def test_nothing_shears_the_joints_of_an_axial_scene(scene_with):
    scene = scene_with(**{"joints.friction_angle": 30.0, "motion.rotation": "finite"})
    reasons = {effect.name: effect.reason for effect in effects(scene) if not effect.active}
    assert reasons["slip"] == "the joints carry no shear"
    assert reasons["finite rotation"] == "the blocks do not rotate"


def test_a_layer_may_be_the_only_joint_with_a_dashpot(scene_with):
    scene = scene_with(soft_layers=[{"y": 20.0, "damping_ratio": 0.1}])
    assert "dashpots" in active_effects(scene)


def test_a_layer_may_be_the_only_joint_without_tension(scene_with):
    scene = scene_with(soft_layers=[{"y": 20.0, "tension": False}])
    reasons = {effect.name: effect.reason for effect in effects(scene)}
    assert reasons["no tension"] == "1 of 99 joints"


def test_every_effect_says_why(scene_with):
    assert all(effect.reason for effect in effects(scene_with()))
