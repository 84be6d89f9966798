"""The effects of a scene, key by key: pillars and rock masses call them by the same names."""

import pytest

from jointwave.cases.effects import active_effects, effects

ACROSS = {"load.direction": [1.0, 0.0, 0.0]}
DOWN = {"direction": [0, -1, 0], "static": False}
RUBS = {"friction_angle": 30.0}
WEAKENS = RUBS | {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3}
DILATES = RUBS | {"dilation_angle": 5.0, "dilation_distance": 1e-2}
BREAKS = {"tensile_strength": 1e5, "fracture_energy": 10.0}
RATED = RUBS | {"direct_effect": 0.01, "evolution_effect": 0.015}
RATED |= {"critical_slip_distance": 1e-4, "reference_rate": 1e-6}
RAYLEIGH = {"rayleigh": {"frequencies": [10.0, 200.0], "ratios": [0.02, 0.02]}}

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
    "softening": {"joints": BREAKS},
    "mass damping": {"damping": {"mass_proportional": 5.0}},
    "local damping": {"damping": {"local": 0.8}},
    "constant Q": {"rock.quality_factor": 20.0},
    "gravity": {"gravity": DOWN},
    "prestress": {"prestress": {"normal": 1e6}},
    "spatial motion, finite rotation": ACROSS | {"motion.rotation": "finite"},
    "spatial motion, slip": ACROSS | {"joints": RUBS},
    "spatial motion, slip, weakening": ACROSS | {"joints": WEAKENS},
    "spatial motion, slip, dilation": ACROSS | {"joints": DILATES},
    "spatial motion, slip, rate and state": ACROSS | {"joints": RATED},
    "fixed ends, shaken base": {"ends.start": "fixed", "load.quantity": "velocity"},
    "dashpots, mass damping": {"damping": RAYLEIGH},
    "dashpots, joints that differ": {"soft_layers": [{"y": 20.0, "damping_ratio": 0.1}]},
}


@pytest.mark.parametrize("names", CALLS)
def test_a_key_of_a_pillar_calls_for_its_effects_alone(pillar, names):
    nothing = {"record.energy": False}
    assert active_effects(pillar(**nothing)) == []
    assert active_effects(pillar(**nothing | CALLS[names])) == names.split(", ")


def test_every_effect_is_called_for_above_and_says_why(pillar):
    every = effects(pillar())
    assert {one.name for one in every} == {name for names in CALLS for name in names.split(", ")}
    assert all(one.reason for one in every)


SPATIAL = {
    "the load has a component across the axis": ACROSS,
    "the load is eccentric": {"load.at": [0.0, 0.1]},
    "the load is a couple": {"load.arm": 0.1},
    "gravity has a component across the axis": {"gravity": DOWN | {"direction": [0.6, -0.8, 0.0]}},
}


@pytest.mark.parametrize("reason", SPATIAL)
def test_what_takes_a_pillar_off_its_axis(pillar, reason):
    scene = pillar(**SPATIAL[reason])
    reasons = {one.name: one.reason for one in effects(scene)}
    assert scene.is_spatial
    assert reasons["spatial motion"] == f"{reason}: 6 degrees of freedom"


def test_axial_gravity_and_a_load_against_the_axis_stay_axial(pillar):
    assert not pillar(gravity=DOWN, **{"load.direction": [0, -1, 0]}).is_spatial


def test_reasons_of_blocks_that_do_not_turn_and_of_one_joint(pillar):
    """Nothing shears the joints of an axial scene; a layer may be the only one without tension."""
    still = effects(pillar(**ACROSS, **{"motion.rotation": "none"}))
    (spatial,) = (one for one in still if one.name == "spatial motion")
    assert spatial.reason.endswith("3 degrees of freedom")
    layers = [{"y": 20.0, "tension": False}]
    scene = pillar(soft_layers=layers, joints=RUBS, **{"motion.rotation": "finite"})
    reasons = {one.name: one.reason for one in effects(scene)}
    assert reasons["slip"] == "the joints carry no shear"
    assert reasons["finite rotation"] == "the blocks do not rotate"
    assert reasons["no tension"] == "1 of 99 joints"


BASE = {"kind": "base", "side": "bottom", "direction": [1.0, 0.0], "quantity": "velocity"}
BASE |= {"shape": "step", "amplitude": 1.0}
#: What each joint set, or the whole scene, calls for besides its waves, quiet sides and ledger.
OF_SETS = {
    "dashpots": {"damping_ratio": 0.02},
    "no tension": {"tension": False},
    "closure": {"maximum_closure": 1e-3},
    "slip": {"cohesion": 0.0},
    "slip, weakening": WEAKENS,
    "slip, dilation": DILATES,
    "softening": BREAKS,
}
OF_ROCK = {
    "dashpots, mass damping": {"damping": RAYLEIGH},
    "field output": {"record__fields": 1e-3},
    "mass damping": {"damping__mass_proportional": 1.0},
    "local damping": {"damping__local": 0.8},
    "gravity": {"gravity": {"static": False}},
    "prestress": {"prestress": {"xx": 1e6, "yy": 2e6}},
    "fixed sides": {"boundaries__top": "fixed"},
    "periodic sides": {"boundaries__left": "periodic", "boundaries__right": "periodic"},
    "shaken base, fixed sides": {"waves": [], "boundaries__bottom": "fixed", "loads": [BASE]},
}
ALWAYS = {"incident waves", "quiet sides", "energy ledger"}


@pytest.mark.parametrize("names", OF_SETS)
def test_an_effect_of_joints_names_its_sets(mass, names):
    scene = mass(**{f"joint_sets__0__{key}": value for key, value in OF_SETS[names].items()})
    assert {*active_effects(scene)} == ALWAYS | {*names.split(", ")}
    found = [one for one in effects(scene) if one.name in names.split(", ")]
    assert all(one.reason.endswith(": joint") for one in found)


@pytest.mark.parametrize("names", OF_ROCK)
def test_a_key_of_a_rock_mass_calls_for_its_effects_alone(mass, names):
    scene = mass(**OF_ROCK[names])
    without = {"incident waves"} if "shaken" in names else set()
    assert {*active_effects(scene)} == ALWAYS - without | {*names.split(", ")}


def test_a_plain_rock_mass_calls_for_its_sides_its_waves_and_its_ledger(mass):
    assert active_effects(mass()) == ["incident waves", "quiet sides", "energy ledger"]
    assert active_effects(mass(record__energy=False)) == ["incident waves", "quiet sides"]
