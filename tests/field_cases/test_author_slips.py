"""Slips of authors, each with what was likely meant: radians, a coefficient, per cent, megapascals.

Users of several programs gave 0.349 for 20 degrees, 0.6 for an angle of friction, 5 for a damping
ratio, 0.5 for a cohesion in MPa. Values and their other readings are converted here by hand; right
values beside them are silent.
"""

import pytest

import jointwave as jw
from jointwave.cases.warnings import warnings

PILLAR = {
    "title": "slips",
    "pillar": {"length": 20.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
    "ends": {"end": "matched"},
    "time": {"duration": 0.05},
    "record": {"stress": [10.0]},
}
FRICTION = {"tension": True, "friction_angle": 30.0}

#: What replaces a table of the pillar, and what is said; nothing where that is right.
OF_PILLARS = {
    "radians": (
        {"joints": FRICTION | {"friction_angle": 0.349}},
        "joints.friction_angle = 0.349 degrees: 0.349 rad is 20 degrees",
    ),
    "coefficient": (
        {"joints": FRICTION | {"friction_angle": 0.6}},
        "a coefficient of 0.6 is 30.96 degrees",
    ),
    "layer": (
        {"soft_layers": [{"y": 5.0} | FRICTION | {"friction_angle": 0.349}]},
        "soft_layers[0].friction_angle = 0.349 degrees",
    ),
    "dynamic": (
        {"joints": FRICTION | {"dynamic_friction_angle": 0.2, "weakening_distance": 1e-3}},
        "joints.dynamic_friction_angle = 0.2 degrees: 0.2 rad is 11.46 degrees",
    ),
    "dilation": (
        {"joints": FRICTION | {"dilation_angle": 0.1, "dilation_distance": 1e-2}},
        "joints.dilation_angle = 0.1 degrees: 0.1 rad is 5.73 degrees",
    ),
    "smooth": ({"joints": FRICTION | {"friction_angle": 0.0}}, ""),
    "angle": ({"joints": FRICTION}, ""),
    "per cent": (
        {"joints": {"damping_ratio": 5.0}},
        "joints.damping_ratio = 5 is overdamped: 5 % is 0.05",
    ),
    "critical": ({"joints": {"damping_ratio": 1.0}}, ""),
    "cohesion": (
        {"joints": {"cohesion": 0.5}},
        "joints.cohesion = 0.5 Pa is far below rock's: 0.5 MPa is 5e+05 Pa",
    ),
    "no cohesion": ({"joints": {"cohesion": 0.0}}, ""),
    "strength": (
        {"joints": {"tensile_strength": 2.0, "fracture_energy": 1.0}},
        "joints.tensile_strength = 2 Pa is far below rock's: 2 MPa is 2e+06 Pa",
    ),
    "closure": (
        {"joints": {"maximum_closure": 0.2}},
        "joints.maximum_closure = 0.2 m is far above rock's: 0.2 mm is 0.0002 m",
    ),
    "amplitude": (
        {"load": PILLAR["load"] | {"amplitude": 1.0}},
        "load.amplitude = 1 Pa is far below that of a load on rock: 1 MPa is 1e+06 Pa",
    ),
    "velocity": (
        {
            "load": PILLAR["load"] | {"amplitude": 80.0, "quantity": "velocity"},
            "ends": {"start": "quiet", "end": "matched"},
        },
        "load.amplitude = 80 m/s is far above that of a load on rock: 80 mm/s is 0.08 m/s",
    ),
    "no load": ({"load": PILLAR["load"] | {"amplitude": 0.0}}, ""),
    "tension": (
        {"prestress": {"normal": -1e6}},
        "prestress.normal = -1e+06 Pa is tension: compression is positive",
    ),
    "megapascal": ({"prestress": {"normal": 5.0}}, "5 MPa is 5e+06 Pa"),
    "pressed": ({"prestress": {"normal": 1e6}}, ""),
    "millimetres": (
        {"pillar": {"length": 50000.0, "side": 500.0, "block": 500.0}},
        "pillar.length = 50000 m is far above rock's: 50000 mm is 50 m",
    ),
    "milliseconds": (
        {"load": PILLAR["load"] | {"period": 10.0}, "time": {"duration": 50.0}},
        "load.period = 10 s: a wave crosses the rock",
    ),
    "blocks of nothing": (
        {"rock": PILLAR["rock"] | {"intact_poisson": 0.3}},
        "rock.intact_poisson = 0.3 is not used: it needs rock.intact_modulus",
    ),
    "hertz": (
        {
            "load": PILLAR["load"] | {"shape": "sine", "period": 100.0},
            "record": {"stress": [10.0], "interval": 1e-4},
        },
        "load.period = 100 s is longer than the scene, time.duration = 0.05 s; 100 Hz is 0.01 s",
    ),
    "friction and tension": (
        {"joints": {"friction_angle": 30.0}},
        "joints.friction_angle without joints.tension: the joint carries any tension",
    ),
    "tension of all joints": (
        {"joints": {"tension": False}, "soft_layers": [{"y": 5.0, "friction_angle": 30.0}]},
        "",
    ),
    "tension of no joint": (
        {"soft_layers": [{"y": 5.0, "friction_angle": 30.0}]},
        "soft_layers[0].friction_angle without soft_layers[0].tension",
    ),
    "a strength says it": (
        {"joints": {"friction_angle": 30.0, "tensile_strength": 1e5, "fracture_energy": 1e2}},
        "",
    ),
}


@pytest.mark.parametrize("name", OF_PILLARS)
def test_a_slip_in_a_pillar_is_named_with_what_was_meant(name):
    changes, words = OF_PILLARS[name]
    found = [line for line in warnings(jw.load(PILLAR | changes)) if _of_slips(line)]
    assert any(words in line for line in found) if words else found == []


def _of_slips(line):
    """Return whether a line is none of how waves are resolved and when they arrive."""
    return not line.startswith(("pillar.block", "ends.", "record.stress", "record.interval"))


LAW = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
OF_ROCK_MASSES = {
    "radians": (LAW | {"dip": 0.524}, {}, "joint_sets[0].dip = 0.524 degrees: 0.524 rad is 30.02"),
    "a right angle": (LAW | {"dip": 1.5708}, {}, "1.5708 rad is 90 degrees"),
    "a small dip": (LAW | {"dip": 0.5}, {}, ""),
    "friction": (LAW | FRICTION | {"friction_angle": 0.349}, {}, "0.349 rad is 20 degrees"),
    "friction and tension": (
        LAW | {"friction_angle": 30.0},
        {},
        "joint_sets[0].friction_angle without joint_sets[0].tension",
    ),
    "spacing": (
        LAW | {"dip": 0.0, "spacing": 2000.0},
        {},
        "joint_sets[0].spacing = 2000 m exceeds the domain, 30 m across its joints; 2000 mm is 2 m",
    ),
    "far receiver": (
        LAW | {"dip": 0.0},
        {"record": {"joints": [[10.0, 20.0]]}},
        "record.joints[0] = [10, 20] is 5 m from the nearest joint",
    ),
    "near receiver": (LAW | {"dip": 0.0}, {"record": {"joints": [[5.0, 15.5]]}}, ""),
    "tension": (LAW, {"prestress": {"xx": 1e6, "yy": -2e6}}, "prestress.yy = -2e+06 Pa is tension"),
    "upwards": (
        LAW,
        {"gravity": {"direction": [0.0, 1.0], "static": False}},
        "gravity.direction = [0, 1] pulls upwards: y points up",
    ),
    "region": (
        LAW | {"dip": 0.0},
        {"regions": [{"name": "r", "dip": 0.0873, "through": [0.0, 10.0], "density": 2500.0}]},
        "regions[0].dip = 0.0873 degrees: 0.0873 rad is 5.002 degrees",
    ),
}


@pytest.mark.parametrize("name", OF_ROCK_MASSES)
def test_a_slip_in_a_rock_mass_is_named_with_what_was_meant(name, one_joint):
    """A joint at 30 degrees through the middle of 20 by 30 m, changed."""
    joint, tables, words = OF_ROCK_MASSES[name]
    own = {"name": "joint", "dip": 30.0, "through": [10.0, 15.0]}
    found = warnings(jw.load(one_joint(joint_sets=[own | joint], **tables)))
    assert any(words in line for line in found) if words else found == []


def test_milliseconds_of_a_wave_are_named(one_joint):
    """Four seconds of P cross 30 m 500 times at the 0.42 Hz of a Ricker wavelet of 4 s."""
    tables = one_joint(time={"duration": 30.0})
    tables["waves"][0]["period"] = 4.0
    found = warnings(jw.load(tables))
    assert any("waves[0].period = 4 s: a wave crosses the rock" in line for line in found)
    assert any("4 ms is 0.004 s" in line for line in found)


def test_explain_says_that_friction_bounds_no_tension(tmp_path, jointwave, in_toml):
    path = tmp_path / "slips.toml"
    path.write_text(in_toml(PILLAR | {"joints": {"friction_angle": 30.0}}))
    said = jointwave("explain", path, "--all")
    assert "every joint carries tension, also with friction" in said.out
    assert "carries any tension" in said.err
