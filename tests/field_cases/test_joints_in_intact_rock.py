"""Three joints in intact rock under a half-sine blast, and rock that is given twice.

A user knows the stiffness of his joints, where they are, and the intact rock. Behind each joint the
wave is that before it times |T| = 2 kappa / sqrt(4 kappa^2 + 1), kappa = K_n / (Z omega), as long
as what the joints reflect has not come back (Schoenberg, JASA 68, 1980)."""

import tomllib
from math import pi, sqrt

import numpy as np
import pytest

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.warnings import warnings
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place

MODULUS, DENSITY, STIFFNESS = 6e10, 2600.0, 6e10
SPEED = sqrt(MODULUS / DENSITY)
ROCK = {"density": DENSITY, "intact_modulus": MODULUS}
PILLAR = {"length": 30.0, "side": 0.5, "joints": [8.0, 15.0, 22.0]}
BLAST = {"shape": "half-sine", "amplitude": 1e6, "period": 1e-3}


def three_joints(**tables):
    """Return the tables of three joints in intact rock, some replaced."""
    own = {
        "title": "three joints in intact rock",
        "pillar": PILLAR,
        "rock": ROCK,
        "joints": {"normal_stiffness": STIFFNESS},
        "load": BLAST,
        "ends": {"end": "matched"},
        "time": {"duration": 0.008},
        "record": {"stress": [4.0, 8.5, 15.5, 22.5]},
    }
    return own | tables


@pytest.mark.parametrize(
    ("engine", "within"), [("dem", 2e-3), ("continuum-jointed", 1e-4), ("jointed-bar", 1e-4)]
)
def test_each_joint_transmits_what_one_joint_does(engine, within):
    """Spectra of the first pulse at each receiver, over that at the one before: in 2.4 ms from its
    arrival the tail of a joint falls to exp(-2 K_n t / Z) = 1e-8, and reflections return after
    2 (7 m - 0.5 m) / c = 2.7 ms. Of rigid blocks, 73 at 1 kHz, a joint transmits
    (k d)^2 / 8 = 0.1 % differently."""
    found = jw.simulate(jw.load(three_joints()), engine).stress
    time, waves = found.time.values, found.values.reshape(4, -1)
    frequency = np.array([200.0, 500.0, 1000.0])
    kappa = STIFFNESS / (DENSITY * SPEED * 2 * pi * frequency)
    spectra = []
    for y, wave in zip(found.stress_y.values, waves, strict=True):
        begin = y / SPEED
        own = (time > begin - 1e-4) & (time < begin + (1.6e-3 if y == 4.0 else 2.4e-3))
        spectra.append(np.abs(np.exp(-2j * pi * np.outer(frequency, time[own])) @ wave[own]))
    passed = np.array(spectra[1:]) / spectra[:-1]
    assert passed == pytest.approx(np.tile(2 * kappa / np.sqrt(4 * kappa**2 + 1), (3, 1)), within)


def test_blocks_are_as_fine_as_the_load_or_the_user_wants():
    """40 a wavelength of the load's highest frequency; of half the period half as long. A size that
    divides no part is the most that blocks have."""
    blocks = [
        np.diff(calibrate(jw.load(three_joints(load=BLAST | {"period": t}))).contact_y).max()
        for t in (1e-3, 0.5e-3)
    ]
    assert blocks[0] == pytest.approx(2 * blocks[1], rel=0.02)
    given = calibrate(jw.load(three_joints(pillar=PILLAR | {"block": 0.6})))
    sizes = np.diff(given.contact_y)
    assert sizes.max() <= 0.6 and sizes.max() == pytest.approx(7 / 12)
    assert set(given.joint_y[given.resolved]) == {8.0, 15.0, 22.0}


def test_a_fit_finds_the_stiffness_of_a_joint():
    """Behind one joint s' = (s_in - s) / T, T = Z / 2K: while a half sine sin(a t) passes,
    s = (sin a t - a T (cos a t - exp(-t/T))) / (1 + (a T)^2). A fit starts at ten times K."""
    begin = three_joints(
        pillar=PILLAR | {"joints": [8.0]},
        load=BLAST | {"period": 4e-3, "quantity": "incident-stress"},
        ends={"start": "matched", "end": "matched"},
        time={"duration": 0.0055},
        record={"stress": [20.0]},
    )
    late, a = 20.0 / SPEED, pi / 2e-3
    time = late + np.linspace(0.0, 1.9e-3, 100)
    lag, t = DENSITY * SPEED / (2 * STIFFNESS / 10), time - late
    passed = (np.sin(a * t) - a * lag * (np.cos(a * t) - np.exp(-t / lag))) / (1 + (a * lag) ** 2)
    curve = Curves("gauge", "gauge.csv", time, {Place("stress", "", (20.0,)): 1e6 * passed})
    found = jw.fit(jw.load(begin), [curve], ["joints.normal_stiffness"], "jointed-bar")
    stiffness = found.values.value["joints.normal_stiffness"]
    assert stiffness == pytest.approx(STIFFNESS / 10, rel=1e-3)


def test_one_of_the_joints_may_have_a_law_of_its_own():
    p = calibrate(jw.load(three_joints(soft_layers=[{"y": 15.0, "normal_stiffness": 1e10}])))
    assert p.own_stiffness[p.resolved] == pytest.approx([STIFFNESS, 1e10, STIFFNESS])


MASS = "pillar = {length = 30.0, side = 0.5, block = 1.0}"
LAYER = "soft_layers = [{y = 15.0, spacing_stiffness = 1e9, normal_stiffness = 1e9}]"
SEGMENT = "segments = [{y = [0.0, 5.0], p_speed = 2e3, s_speed = 1e3, normal_stiffness = 1e9}]"
SPEEDS = "rock.p_speed = 2000.0; rock.s_speed = 1100.0"
REFUSED = {
    f"{MASS}; {SPEEDS}": (
        "joints.normal_stiffness = 60000000000.0: decides what rock.p_speed and rock.s_speed "
        "would decide: leave out these"
    ),
    f"{MASS}; rock.equivalent_modulus = 1e10; rock.equivalent_poisson = 0.2": (
        "joints.normal_stiffness = 60000000000.0: decides what rock.equivalent_modulus would"
    ),
    f"{MASS}; {SPEEDS}; joints = {{shear_stiffness = 1e9}}": (
        "joints.shear_stiffness = 1000000000.0: decides what rock.p_speed and rock.s_speed"
    ),
    f"{MASS}; {SEGMENT}": (
        "segments[0].normal_stiffness = 1000000000.0: decides what segments[0].p_speed and"
    ),
    f"{MASS}; joints.normal_stiffness = 1e9; {LAYER}": (
        "soft_layers[0].spacing_stiffness = 1000000000.0: give this or normal_stiffness"
    ),
    f"{MASS}; no joints": "rock: give exactly one pair",
    "rock.p_speed = 5e3": "rock.p_speed = 5000.0: leave it out",
    "no rock.intact_modulus": "rock.intact_modulus: is required with pillar.joints",
    "joints = {}": "joints.normal_stiffness: is required with pillar.joints",
    "pillar.joints = [8.0, 31.0]": "pillar.joints = [8.0, 31.0]: must be diff",
    "pillar.joints = []": "pillar.joints = []: must be different places",
    'pillar.joints = ["8"]': "pillar.joints[0] = '8': must be a number",
    "segments = [{y = [0.0, 5.0]}]": "segments: cannot be combined with pillar.joints",
    "joints.damping_ratio = 0.1": "joints.damping_ratio = 0.1: needs a block between joints",
}


@pytest.mark.parametrize("changes", REFUSED)
def test_rock_given_twice_or_not_at_all_is_refused(changes, changed, in_toml):
    with pytest.raises(SceneError) as error:
        jw.load(tomllib.loads(changed(in_toml(three_joints()), changes)))
    assert REFUSED[changes] in str(error.value)


def test_stiffness_of_joints_and_intact_rock_are_the_rock_mass():
    """1 / E_eq = 1 / E + 1 / (S K_n), (4): 3e10 Pa of rock and joints of 6e10 Pa each, 1 m apart;
    Poisson's ratio is the intact rock's where no other is given."""
    mass = {"length": 30.0, "side": 0.5, "block": 1.0}
    p = calibrate(jw.load(three_joints(pillar=mass)))
    assert p.modulus == pytest.approx(3e10) and p.poisson == 0.25
    rock = ROCK | {"equivalent_poisson": 0.4}
    assert calibrate(jw.load(three_joints(pillar=mass, rock=rock))).poisson == 0.4


def test_joints_of_two_sets_on_one_line_are_warned_of(one_joint):
    """Every third joint of one set is every second of the other: 6, 12, 18 and 24 m. At 0 and 30 m
    are the sides, along which no joint lies."""
    law = {"dip": 0.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    sets = [law | {"name": "a", "spacing": 2.0}, law | {"name": "b", "spacing": 3.0, "dip": 180.0}]
    for through, count in ((0.0, 4), (1.0, 5), (0.5, 0)):  # of 1, 4, 7: those of even numbers
        sets[1]["through"] = [0.0, through]
        found = [line for line in warnings(jw.load(one_joint(joint_sets=sets))) if "common" in line]
        words = f"joint_sets[1] and joint_sets[0] have {count} joints in common"
        assert len(found) == (count > 0) and all(words in line for line in found)


@pytest.mark.parametrize("joint", [[], [18.0]], ids=["alone", "with a joint parallel to it"])
def test_blocks_have_the_poisson_effect_of_a_seam(one_joint, joint):
    """A third of a block thick, at two fifths of the rock's modulus. Without a Poisson effect the
    stress in it, and of linear waves nothing else is, would be off by nu / (1 - nu) = 1/3 in the
    direction along it. The shortest wave, of 166 Hz, is 29 m long: on its way of 20 m triangles
    with edges of 1.2 m delay it by k L (k d)^2 / 24 = 0.012 radians."""
    law = {"name": "j", "dip": 0.0, "normal_stiffness": 2e10, "shear_stiffness": 2e10}
    places = {"seam": [8.0, 12.0], "above": [8.0, 12.3]}
    moduli = {"seam": 2e10, "above": 5e10}
    wave = one_joint()["waves"][0] | {"period": 0.01}
    tables = {
        "domain": {"size": [16.0, 24.0]},
        "joint_sets": [law | {"through": [8.0, y]} for y in joint],
        "regions": [
            {"name": name, "through": at, "intact_modulus": moduli[name]}
            for name, at in places.items()
        ],
        "waves": [wave],
        "record": {"points": [[8.0, 5.0], [8.0, 12.15], [8.0, 20.0]]},
        "numerics": {"dem": {"block": 1.0}},
    }
    scene = jw.load(one_joint(**tables))
    blocks, exact = (jw.simulate(scene, name) for name in ("dem", "parallel-joints"))
    for variable in ("velocity", "stress"):
        own, expected = blocks[variable].values, exact[variable].values
        off = np.linalg.norm(own - expected, axis=(1, 2)) / np.linalg.norm(expected, axis=(1, 2))
        assert (off <= 0.012).all(), (variable, off)
