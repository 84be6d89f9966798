"""Slips of authors, each with what was likely meant: radians, a coefficient, per cent, megapascals.

Users of several programs gave 0.349 for 20 degrees, 0.6 for an angle of friction, 5 for a damping
ratio, 0.5 for a cohesion in MPa. Values and their other readings are converted here by hand; right
values beside them are silent."""

import tomllib

import pytest

import jointwave as jw
from jointwave.cases.warnings import warnings
from tests.field_cases.scenes import mass, wave

PILLAR = """
title = "slips"
pillar = { length = 20.0, side = 0.5, block = 0.5 }
rock = { density = 2400.0, p_speed = 2200.0, s_speed = 800.0 }
load = { shape = "ricker", amplitude = 1e6, period = 0.01 }
ends = { end = "matched" }
time = { duration = 0.05 }
record = { stress = [10.0] }
"""
FRICTION = "joints.tension = true; joints.friction_angle = "
WEAKENS = f"{FRICTION}30.0; joints.weakening_distance = 1e-3; joints.dynamic_friction_angle"
DILATES = f"{FRICTION}30.0; joints.dilation_distance = 1e-2; joints.dilation_angle"
BREAKS = "joints.fracture_energy = 1.0; joints.tensile_strength"
SHAKEN = 'ends.start = "quiet"; load.quantity = "velocity"; load.amplitude'

#: What is changed of the pillar, and what is said behind the key and its value as they are changed
#: last, or behind what follows an arrow; nothing where that is right.
OF_PILLARS = {
    f"{FRICTION}0.349": "degrees: 0.349 rad is 20 degrees",
    f"{FRICTION}0.6": "a coefficient of 0.6 is 30.96 degrees",
    f"{FRICTION}0.0": "",
    f"{FRICTION}30.0": "",
    "soft_layers = [{y = 5.0, tension = true, friction_angle = 0.349}] -> soft_layers[0]": (
        "friction_angle = 0.349 degrees"
    ),
    f"{WEAKENS} = 0.2": "degrees: 0.2 rad is 11.46 degrees",
    f"{DILATES} = 0.1": "degrees: 0.1 rad is 5.73 degrees",
    "joints.damping_ratio = 5": "is overdamped: 5 % is 0.05",
    "joints.damping_ratio = 1.0": "",
    "joints.cohesion = 0.5": "Pa is far below rock's: 0.5 MPa is 5e+05 Pa",
    "joints.cohesion = 0.0": "",
    f"{BREAKS} = 2": "Pa is far below rock's: 2 MPa is 2e+06 Pa",
    "joints.maximum_closure = 0.2": "m is far above rock's: 0.2 mm is 0.0002 m",
    "load.amplitude = 1": "Pa is far below that of a load on rock: 1 MPa is 1e+06 Pa",
    "load.amplitude = 0.0": "",
    f"{SHAKEN} = 80": "m/s is far above that of a load on rock: 80 mm/s is 0.08 m/s",
    "prestress.normal = -1e+06": "Pa is tension: compression is positive",
    "prestress.normal = 5": "5 MPa is 5e+06 Pa",
    "prestress.normal = 1e6": "",
    "pillar = {length = 50000.0, side = 500.0, block = 500.0} -> pillar.length = 50000": (
        "m is far above rock's: 50000 mm is 50 m"
    ),
    "time.duration = 50.0; load.period = 10": "s: a wave crosses the rock",
    "rock.intact_poisson = 0.3": "is not used: it needs rock.intact_modulus",
    'load.shape = "sine"; record.interval = 1e-4; load.period = 100': (
        "s is longer than the scene, time.duration = 0.05 s; 100 Hz is 0.01 s"
    ),
    "joints.friction_angle = 30.0 -> joints.friction_angle without joints.tension": (
        "the joint carries any tension"
    ),
    "joints.tension = false; soft_layers = [{y = 5.0, friction_angle = 30.0}]": "",
    "soft_layers = [{y = 5.0, friction_angle = 30.0}] -> soft_layers[0].friction_angle": (
        "without soft_layers[0].tension"
    ),
    "joints = {friction_angle = 30.0, tensile_strength = 1e5, fracture_energy = 1e2}": "",
}
DIPS = "joint_sets[0].dip = "
OF_ROCK_MASSES = {
    f"{DIPS}0.524": "degrees: 0.524 rad is 30.02",
    f"{DIPS}1.5708": "1.5708 rad is 90 degrees",
    f"{DIPS}0.5": "",
    "joint_sets[0].tension = true; joint_sets[0].friction_angle = 0.349": "0.349 rad is 20 degrees",
    "joint_sets[0].friction_angle = 30.0 -> joint_sets[0].friction_angle": (
        "without joint_sets[0].tension"
    ),
    f"{DIPS}0.0; joint_sets[0].spacing = 2000": (
        "m exceeds the domain, 30 m across its joints; 2000 mm is 2 m"
    ),
    f"{DIPS}0.0; record.joints = [[10, 20]] -> record.joints[0] = [10, 20]": (
        "is 5 m from the nearest joint"
    ),
    f"{DIPS}0.0; record.joints = [[5.0, 15.5]]": "",
    "prestress = {xx = 1e6, yy = -2e6} -> prestress.yy = -2e+06": "Pa is tension",
    "gravity = {static = false}; gravity.direction = [0, 1]": "pulls upwards: y points up",
    "gravity = {static = false}; gravity.direction = [-1, 0]": "pulls sideways: y points up",
    f'{DIPS}0.0; regions = [{{name = "r", through = [0, 10], density = 2500.0}}]; '
    "regions[0].dip = 0.0873": "degrees: 0.0873 rad is 5.002 degrees",
    "time.duration = 30.0; waves[0].period = 4": "s: a wave crosses the rock",  # 500 times
}
OTHERS = ("pillar.block", "ends.", "record.stress", "record.interval")


@pytest.mark.parametrize("mistake", OF_PILLARS | OF_ROCK_MASSES)
def test_a_slip_is_named_with_what_was_meant(mistake, spoilt, one_joint, in_toml):
    """In a pillar, or of a joint at 30 degrees through the middle of 20 by 30 m of rock; but for
    how waves are resolved and when they arrive."""
    good = PILLAR if mistake in OF_PILLARS else in_toml(one_joint())
    words = (OF_PILLARS | OF_ROCK_MASSES)[mistake]
    text, named = spoilt(good, mistake)
    found = [x for x in warnings(jw.load(tomllib.loads(text))) if not x.startswith(OTHERS)]
    assert any(x.startswith(named) and words in x for x in found) if words else not found, found


def test_explain_says_that_friction_bounds_no_tension(tmp_path, jointwave, changed):
    path = tmp_path / "slips.toml"
    path.write_text(changed(PILLAR, "joints.friction_angle = 30.0"))
    told = jointwave("explain", path, "--all")
    assert "every joint carries tension, also with friction" in told.out
    assert "carries any tension" in told.err


@pytest.mark.parametrize(
    ("direction", "more", "words"),
    [
        # Across the vertical plane, as here, it would be SH.
        ([0.6, 0.0, 0.8], {"polarisation": [0.0, 1.0, 0.0]}, "SV is polarised in the vertical pl"),
        ([0.0, 0.0, 1.0], {}, "a vertical wave is of no kind 'SV'"),
    ],
)
def test_waves_in_space_do_not_contradict_their_kind(direction, more, words):
    space = mass(
        *(2.0, 2.0),
        domain={"size": [2.0, 2.0, 2.0]},
        waves=[wave("SV", direction) | more],
        boundaries=dict.fromkeys(("left", "right", "front", "back", "bottom", "top"), "quiet"),
        time={"duration": 2e-3},
        record={"points": [[1.0, 1.0, 1.0]]},
    )
    with pytest.raises(jw.SceneError, match=words):
        jw.load(space)
