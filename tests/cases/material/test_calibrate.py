"""Equations (4) to (7) of Guo & Li (2002): the paper's numbers, and both ways round."""

import gc
from weakref import ref

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases import load
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.rock import (
    equivalent_modulus,
    joint_stiffness,
    modulus_from_speeds,
    speeds_from_modulus,
)

DENSITY, INTACT, SPACING = 2400.0, 8.64e10, 0.5
CONSTANTS = {"density": DENSITY, "equivalent_modulus": 4.375e9, "equivalent_poisson": 0.42}
CONSTANTS |= {"intact_modulus": INTACT}

speeds = st.floats(10.0, 1e4)
moduli = st.floats(1e6, 1e12)


@pytest.fixture
def paper(scene_with):
    """The properties of the paper's pillar."""
    return calibrate(scene_with())


def test_elastic_constants_of_the_rock_mass(paper):
    assert paper.poisson == pytest.approx(0.4238, abs=5e-5)
    assert paper.modulus == pytest.approx(4.375e9, rel=1e-3)


def test_shear_constants_of_the_paper(paper):
    """G = rho c_s^2 and c_s come back to the last bit; K'_s is equation (7)."""
    assert paper.shear_modulus == DENSITY * 800.0**2 == 1.536e9
    assert paper.shear_speed == 800.0
    assert paper.shear_impedance == DENSITY * 800.0
    assert paper.regular_shear_stiffness == paper.shear_modulus / SPACING
    shear = paper.regular_stiffness / (2 * (1 + paper.poisson))
    assert paper.shear_stiffness == pytest.approx(shear, rel=1e-14)


def test_inertia_of_a_block(scene_with):
    """Of the cuboid a x d x a, by the integral of its squared distances from an axis."""
    p = calibrate(scene_with(**{"pillar.block": 1.25}))
    assert p.inertia_across == pytest.approx(p.block_mass * (0.5**2 + 1.25**2) / 12)
    assert p.inertia_along == pytest.approx(p.block_mass * 2 * 0.5**2 / 12)


def test_joint_stiffness_of_the_paper(paper):
    assert SPACING * paper.own_stiffness[0] == pytest.approx(4.608e9, rel=1e-3)
    assert paper.stiffness[0] / paper.own_stiffness[0] == pytest.approx(0.949, abs=5e-4)


def test_bar_speed_is_not_the_p_wave_speed(paper):
    assert paper.bar_speed == pytest.approx(1350, rel=1e-3)
    assert paper.impedance == pytest.approx(DENSITY * paper.bar_speed)


def test_blocks_and_joints_of_the_paper(paper):
    assert paper.block_count == 100
    assert paper.joint_y == pytest.approx(np.arange(0.5, 49.75, 0.5))
    assert paper.block_mass == pytest.approx(2400 * 0.5**3)
    assert paper.tension.all()
    assert paper.time_constant is None and paper.joint_time_constant is None


@given(s=speeds, ratio=st.floats(1.2, 10.0), density=st.floats(500, 5000))
def test_speeds_to_modulus_and_back(s, ratio, density):
    modulus, poisson = modulus_from_speeds(ratio * s, s, density)
    assert speeds_from_modulus(modulus, poisson, density) == pytest.approx((ratio * s, s))


@given(e=moduli, poisson=st.floats(-0.5, 0.49), density=st.floats(500, 5000))
def test_modulus_to_speeds_and_back(e, poisson, density):
    p, s = speeds_from_modulus(e, poisson, density)
    assert modulus_from_speeds(p, s, density) == pytest.approx((e, poisson), rel=1e-6, abs=1e-9)


@given(e=moduli, factor=st.floats(1.01, 100.0), spacing=st.floats(0.01, 10.0))
def test_modulus_to_stiffness_and_back(e, factor, spacing):
    own = joint_stiffness(e, factor * e, spacing)
    assert equivalent_modulus(own, factor * e, spacing) == pytest.approx(e)
    assert 1 / (1 / own + spacing / (factor * e)) == pytest.approx(e / spacing)


def test_given_joint_stiffness_decides_the_modulus(scene_with):
    rock = {"density": DENSITY, "intact_modulus": INTACT}
    p = calibrate(scene_with(rock=rock, **{"joints.normal_stiffness": 9.216e9}))
    assert p.modulus == pytest.approx(4.375e9, rel=1e-3) and p.poisson == 0.25


def test_damping_ratio_gives_the_dashpot_of_each_contact(scene_with):
    p = calibrate(scene_with(**{"joints.damping_ratio": 0.1}))
    k = p.stiffness * p.area
    dashpot = p.joint_time_constant * k
    assert dashpot == pytest.approx(2 * 0.1 * np.sqrt(p.block_mass * k))


def test_soft_layer_changes_its_own_joint_alone(paper_folder):
    p = calibrate(load(paper_folder / "fig-07.toml")[1])
    assert p.soft.tolist() == [39]
    assert SPACING * p.own_stiffness[39] == pytest.approx(4.375e8)
    assert p.stiffness[39] == pytest.approx(1 / (1 / p.own_stiffness[39] + SPACING / INTACT))
    assert np.delete(p.stiffness, 39) == pytest.approx(p.regular_stiffness)


def test_soft_layer_is_soft_in_shear_too(paper_folder):
    p = calibrate(load(paper_folder / "fig-07.toml")[1])
    assert p.shear_stiffness[39] == pytest.approx(p.stiffness[39] / (2 * (1 + p.poisson)))
    assert np.delete(p.shear_stiffness, 39) == pytest.approx(p.regular_shear_stiffness)


def test_shear_stiffness_of_one_joint_is_in_series_with_its_rock(scene_with):
    p = calibrate(scene_with(soft_layers=[{"y": 20.0, "shear_stiffness": 2e9}]))
    rock = INTACT / (2 * (1 + 0.25)) / SPACING  # intact_poisson is 0.25
    assert p.shear_stiffness[39] == pytest.approx(1 / (1 / 2e9 + 1 / rock), rel=1e-15)
    assert p.stiffness[39] == p.regular_stiffness


def test_shear_stiffness_of_rock_that_is_not_given_is_the_joint_alone(scene_with):
    rock = {"density": DENSITY, "equivalent_modulus": 4.375e9, "equivalent_poisson": 0.42}
    p = calibrate(scene_with(rock=rock, **{"joints.shear_stiffness": 2e9}))
    assert p.shear_stiffness == pytest.approx(2e9, rel=1e-15)


def test_shear_stiffness_of_all_joints_decides_the_shear_modulus(scene_with):
    """As the normal stiffness does the modulus, so that quiet ends fit the chain."""
    p = calibrate(scene_with(rock=CONSTANTS, **{"joints.shear_stiffness": 2e9}))
    assert p.shear_stiffness == pytest.approx(p.shear_modulus / SPACING, rel=1e-15)
    assert p.shear_speed == np.sqrt(p.shear_modulus / DENSITY)
    assert p.modulus == calibrate(scene_with(rock=CONSTANTS)).modulus


def test_a_soft_layer_inherits_the_shear_stiffness_of_the_joints(scene_with):
    layer = {"y": 20.0, "spacing_stiffness": 4e8}
    p = calibrate(
        scene_with(rock=CONSTANTS, soft_layers=[layer], **{"joints.shear_stiffness": 2e9})
    )
    assert p.shear_stiffness[39] == p.shear_stiffness[0]


def test_layer_without_keys_is_an_ordinary_joint(scene_with):
    layered = calibrate(scene_with(soft_layers=[{"y": 20.0}]))
    assert layered.stiffness == pytest.approx(calibrate(scene_with()).stiffness, rel=1e-15)
    assert layered.joint_time_constant is None


def test_without_intact_rock_there_is_no_own_stiffness(scene_with):
    rock = {"density": 2400.0, "equivalent_modulus": 4.375e9, "equivalent_poisson": 0.42}
    p = calibrate(scene_with(rock=rock))
    assert p.own_stiffness is None and p.intact_modulus is None
    assert p.bar_speed == pytest.approx(np.sqrt(4.375e9 / 2400))


def test_a_scene_is_calibrated_once_while_it_lives(pillar):
    """A run asks several times; another scene, equal or not, has properties of its own."""
    scene = pillar()
    found = calibrate(scene)
    assert calibrate(scene) is found
    assert calibrate(pillar(joints__damping_ratio=0.1)).time_constant != found.time_constant
    assert calibrate(scene) is not found
    kept = ref(calibrate(scene))
    del scene
    gc.collect()
    assert kept() is None
