"""Warnings of rock masses: a line for each likely mistake, none for a scene that is meant."""

import pytest

from jointwave.cases.warnings import warnings

#: b = sqrt(E / (2 (1 + nu) rho)) of the rock, over 1.664 / T of a Ricker wavelet, where 95 % of its
#: energy lies below: what blocks and elements are measured by, m.
SHORTEST = (5e10 / 2.5 / 2600) ** 0.5 * 0.005 / 1.664
SETS = [
    {"name": name, "dip": dip, "spacing": 2.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    for name, dip in (("a", 0.0), ("b", 90.0))
]
PRESSURE = {"kind": "pressure", "side": "left", "shape": "step", "amplitude": 1e5}


def test_a_scene_that_is_meant_has_none(mass):
    assert warnings(mass()) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rock__intact_modulus": 50.0}, "rock.intact_modulus = 50 Pa is far below rock's"),
        ({"rock__density": 2.6}, "2.6 g/cm3 is 2600 kg/m3"),
        ({"joint_sets__0__normal_stiffness": 10.0}, "joint_sets[0].normal_stiffness = 10 Pa/m"),
        ({"rock__intact_poisson": -0.1}, "rock.intact_poisson = -0.1 is negative"),
        (
            {"waves__0__period": 0.05},
            "waves[0].period = 0.05 s: the wavelet peaks at 1.5 periods, after the end",
        ),
        (
            {"waves": [], "loads": [PRESSURE | {"shape": "sine", "period": 0.04}]},
            "loads[0].period = 0.04 s is longer than the scene",
        ),
        ({"damping__local": 0.5}, "damping.local distorts waves"),
        ({"numerics__dem__block": 1.0}, "numerics.dem.block = 1 m gives 8.33 rigid blocks"),
        ({"numerics__continuum__size": 2.0}, "numerics.continuum.size = 2 m, of order 2, gives"),
        ({"joint_sets": SETS}, "the joint sets give 4.17 rigid blocks"),
    ],
)
def test_a_likely_mistake_is_a_line(mass, changes, words):
    assert any(words in line for line in warnings(mass(**changes))), warnings(mass(**changes))


def test_the_bound_of_blocks_and_nodes_is_ten_a_wavelength(mass):
    for key, each in (("dem__block", 1), ("continuum__size", 2)):  # of elements of order 2
        for part, count in ((0.99, 0), (1.01, 1)):
            found = warnings(mass(**{f"numerics__{key}": part * each * SHORTEST / 10}))
            assert len(found) == count, (key, part, found)


def test_a_wave_across_one_set_is_measured_by_its_spacing(mass):
    """Rigid slabs carry a wave across them, however long they are."""
    fine = SETS[0] | {"spacing": 0.5, "through": [0.0, 0.1]}
    assert warnings(mass(joint_sets=[fine])) == []
    assert len(warnings(mass(joint_sets=[fine], waves__0__direction=[0.6, 0.8]))) == 1


def test_receivers_that_nothing_reaches_are_named(mass):
    """The wave begins at y = 0 and takes 25 m / a; a Ricker wavelet is felt from 0.646 T on."""
    speed = (5e10 * 0.75 / (1.25 * 0.5) / 2600) ** 0.5
    at = 0.6456 * 0.005 + 25 / speed
    (line,) = warnings(mass(time__duration=0.99 * at))
    assert line.startswith(f"record.points[1] = [10, 25] is reached at {at:.4g} s")
    assert warnings(mass(time__duration=1.01 * at)) == []


def test_what_a_load_reaches_is_measured_from_where_it_acts(mass):
    """From the left side 10 m at the speed of P; from a point force its distance."""
    speed = (5e10 * 0.75 / (1.25 * 0.5) / 2600) ** 0.5
    force = {
        "kind": "force",
        "quantity": "force",
        "shape": "step",
        "amplitude": 1e5,
        "at": [10.0, 5.0],
        "direction": [1.0, 0.0],
    }
    left = {"waves": [], "loads": [PRESSURE], "boundaries__left": "free"}
    assert warnings(mass(**left, time__duration=1.01 * 10 / speed, record__interval=1e-5)) == []
    assert len(warnings(mass(**left, time__duration=0.99 * 10 / speed, record__interval=1e-5))) == 3
    beside = {"waves": [], "loads": [force]}
    found = warnings(mass(**beside, time__duration=1.01 * 10 / speed, record__interval=1e-5))
    assert [line.split(" = ")[0] for line in found] == ["record.points[1]"]


def test_a_wave_that_is_inside_before_the_scene_begins_is_named(mass):
    """From 18 m above the bottom a P wave has entered 18 m / a before t = 0; from 2 m its first
    0.646 T have, which are none of it."""
    speed = (5e10 * 0.75 / (1.25 * 0.5) / 2600) ** 0.5
    assert not any("through" in line for line in warnings(mass(waves__0__through=[0.0, 2.0])))
    (line,) = (x for x in warnings(mass(waves__0__through=[0.0, 18.0])) if "through" in x)
    assert f"enters the domain {18 / speed:.3g} s before t = 0" in line


def test_gravity_that_acts_suddenly_reaches_everything(mass):
    assert warnings(mass(time__duration=0.008, gravity={"static": False})) == []
