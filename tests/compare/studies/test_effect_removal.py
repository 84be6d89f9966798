"""Leaving an effect out of a scene leaves exactly that one out."""

import pytest

from jointwave.cases.effects import active_effects, effects
from jointwave.cases.errors import SceneError
from jointwave.cases.read import load_tables
from jointwave.cases.schema.law_parts import PARTS
from jointwave.compare.studies.effects import WITHOUT, left_out

LAYER = [{"y": 20.0, "spacing_stiffness": 4e8, "damping_ratio": 0.05, "tension": False}]
ACROSS = {"load__direction": [0.6, 0.8, 0.0]}
#: Keys of the parts of the joint law, at common values.
OF_PART = {
    "closure": {"maximum_closure": 1e-3},
    "weakening": {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3},
    "dilation": {"dilation_angle": 5.0, "dilation_distance": 1e-2},
    "rate and state": {"direct_effect": 0.01, "evolution_effect": 0.015}
    | {"critical_slip_distance": 1e-4, "reference_rate": 1e-6},
    "softening": {"tensile_strength": 1e5, "fracture_energy": 100.0},
}
FALL = {"direction": [0, 1, 0], "static": False}


def law(part):
    """Return the keys of a part of the joint law, of a pillar struck across where it is of slip."""
    slides = ACROSS | {"joints__friction_angle": 30.0} if part.along else {}
    return slides | {f"joints__{key}": value for key, value in OF_PART[part.name].items()}


CALLS = {part.name: law(part) for part in PARTS} | {
    "dashpots": {"joints__damping_ratio": 0.02, "soft_layers": LAYER},
    "no tension": {"joints__tension": False, "soft_layers": LAYER},
    "segments": {"segments": [{"y": [10.0, 20.0], "density": 2600.0}]},
    "scatter": {"scatter": {"spacing": 0.2, "seed": 1}},
    "joints that differ": {"soft_layers": LAYER},
    "quiet ends": {"ends__end": "quiet"},
    "matched ends": {"ends__start": "matched"},
    "fixed ends": {"ends__end": "fixed"},
    "energy ledger": {},
    "field output": {"record__fields": 0.01},
    "finite rotation": {**ACROSS, "motion__rotation": "finite"},
    "slip": {**ACROSS, "joints__friction_angle": 30.0, "joints__cohesion": 1e4},
    "mass damping": {"damping__mass_proportional": 5.0},
    "local damping": {"damping": {"local": 0.5}},
    "constant Q": {"rock__quality_factor": 20.0},
    "gravity": {"gravity": FALL},
    "prestress": {"prestress": {"normal": 1e5}},
}


ROWS = {
    "name": "rows",
    "dip": 0.0,
    "spacing": 2.0,
    "normal_stiffness": 1e10,
    "shear_stiffness": 4e9,
}
COLUMNS = ROWS | {"name": "columns", "dip": 90.0}
PRESS = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e6, "period": 0.004}
WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "step", "amplitude": 1e6}
ACTS = {"loads", "incident waves", "shaken base"}


def law_in_plane(part):
    """Return the joints of a part of the joint law."""
    slides = {"friction_angle": 30.0} if part.along else {}
    return {"joint_sets": [ROWS | slides | OF_PART[part.name], COLUMNS]}


IN_PLANE = {part.name: law_in_plane(part) for part in PARTS} | {
    "dashpots": {"joint_sets": [ROWS | {"damping_ratio": 0.02}, COLUMNS]},
    "no tension": {"joint_sets": [ROWS | {"tension": False}, COLUMNS]},
    "slip": {"joint_sets": [ROWS | {"friction_angle": 30.0, "cohesion": 1e4}, COLUMNS]},
    "quiet sides": {"boundaries": {"bottom": "quiet"}},
    "fixed sides": {"boundaries": {"bottom": "fixed"}},
    "roller sides": {"boundaries": {"bottom": "roller"}},
    "periodic sides": {"boundaries": {"left": "periodic", "right": "periodic"}},
    "energy ledger": {"record": {"points": [[6.0, 3.0]]}},
    "field output": {"record": {"points": [[6.0, 3.0]], "energy": False, "fields": 1e-3}},
    "mass damping": {"damping": {"mass_proportional": 5.0}},
    "local damping": {"damping": {"local": 0.5}},
    "constant Q": {"rock": {"density": 2600.0, "intact_modulus": 5e10, "quality_factor": 20.0}},
    "gravity": {"gravity": {"static": False}},
    "prestress": {"prestress": {"xx": 1e6, "yy": 2e6}},
}


def mass(**tables):
    """Blocks of 2 m in 12 m by 10 m, free, pressed at the top, without a ledger."""
    ours = {
        "title": "blocks",
        "domain": {"size": [12.0, 10.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": [ROWS, COLUMNS],
        "loads": [PRESS],
        "time": {"duration": 0.01},
        "record": {"points": [[6.0, 3.0]], "energy": False},
    }
    return load_tables(ours | tables)


def removed(scene, effect):
    """Return the effects that leaving one out removes, and those that it adds."""
    before, after = set(active_effects(scene)), set(active_effects(left_out(scene, effect)))
    return before - after, after - before


@pytest.mark.parametrize("effect", CALLS)
def test_a_pillar_keeps_the_others(effect, pillar):
    """But dashpots and what bars tension in a layer that goes with the layers."""
    of_layer = {"dashpots", "no tension"} if effect == "joints that differ" else set()
    assert removed(pillar(**CALLS[effect]), effect) == ({effect} | of_layer, set())


@pytest.mark.parametrize("effect", IN_PLANE)
def test_a_rock_mass_keeps_the_others(effect):
    assert removed(mass(**IN_PLANE[effect]), effect) == ({effect}, set())


def test_every_effect_is_tried():
    """Those of a rock mass are left out or are what acts."""
    assert set(CALLS) == {name for name in WITHOUT if not name.endswith(" sides")}
    assert {one.name for one in effects(mass())} == set(IN_PLANE) | ACTS


def test_what_the_scene_is_about_stays(pillar):
    for scene, effect in ((pillar(**ACROSS), "spatial motion"), (mass(), "loads")):
        with pytest.raises(SceneError, match="is the subject of the scene"):
            left_out(scene, effect)


def test_an_end_or_a_side_that_is_needed_stays(pillar):
    """The reason is the scene's own: a base that shakes, a side that a wave enters."""
    load = {"shape": "sine", "amplitude": 0.1, "period": 0.01, "quantity": "velocity"}
    with pytest.raises(SceneError, match=r"load\.quantity .*needs ends\.start"):
        left_out(pillar(ends__start="fixed", load=load), "fixed ends")
    scene = mass(boundaries={"bottom": "quiet"}, waves=[WAVE], loads=[])
    with pytest.raises(SceneError, match=r"must be 'quiet': waves\[0\] enters there"):
        left_out(scene, "quiet sides")
