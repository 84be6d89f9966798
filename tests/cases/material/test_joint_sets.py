"""Joints in numbers: dashpots, strength under a prestress, closure by roughness and the stress in
reach of a scene, and what joints make of the dashpots of quiet sides."""

import numpy as np
import pytest

from jointwave.cases.material.closure import bandis_closure, stress_in_reach
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.material.rock_mass import beyond_strength, set_time_constants
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import InSituStress


def damped(rock_with, *sets, **tables):
    """Return the time constants of joints of 1e10 Pa/m in 40 m by 30 m of rock of 2500 kg/m3."""
    tables |= {"domain": {"size": [40.0, 30.0]}}
    tables |= {"rock": {"density": 2500.0, "intact_modulus": 5e10}}
    return set_time_constants(rock_with(*sets, **tables))


def test_the_mass_of_a_dashpot_is_that_of_the_rock_from_joint_to_joint(rock_with):
    """m = 2500 x 4 = 1e4 kg/m2, c = 2 x 0.05 sqrt(1e4 x 1e10) = 1e6 Pa s/m, eta = c / 1e10; a
    joint alone cuts the 30 m in halves of 15 m, an upright one the 40 m, one at 45 degrees 70 m
    over sqrt(2)."""
    spaced, alone = {"dip": 30.0, "spacing": 4.0}, {"dip": 0.0, "through": [20.0, 15.0]}
    zeta = {"damping_ratio": 0.05}
    each = [spaced | zeta, spaced, *(alone | zeta | {"dip": dip} for dip in (0.0, 90.0, 45.0))]
    apart = np.array([15, 20, 35 / np.sqrt(2)])
    expected = [1e-4, 0, *(0.1 * np.sqrt(2500 * apart / 1e10))]
    assert damped(rock_with, *each) == pytest.approx(expected, rel=1e-12)
    assert damped(rock_with, spaced | {"damping_ratio": 0.0}) is None


def test_rayleigh_gives_all_joints_one_time_constant(rock_with):
    """zeta = 0.02 at 100 Hz and 0.01 at 200 Hz: beta = 0, all of it is alpha; twice as much at
    twice the frequency is beta alone, zeta / (pi f)."""
    joints, law = {"dip": 0.0, "spacing": 4.0}, {"frequencies": [100, 200]}
    rising, falling = ({"rayleigh": law | {"ratios": r}} for r in ([0.01, 0.02], [0.02, 0.01]))
    assert damped(rock_with, joints, damping=rising) == pytest.approx([1e-4 / np.pi], rel=1e-12)
    assert damped(rock_with, joints, damping=falling) is None


#: At 30 degrees: t_n = 1 x 1/4 + 5 x 3/4 = 4 MPa, |t_s| = 4 sqrt(3)/4 = 1.732 MPa.
PRESSED = {"xx": 1e6, "yy": 5e6}
PULLED = {"xx": -1e6, "yy": -1e6}


@pytest.mark.parametrize(
    ("stress", "law", "found"),
    [
        (PRESSED, {}, None),
        (PRESSED, {"friction_angle": 23.42}, None),  # atan(sqrt(3)/4) = 23.413 degrees
        (PRESSED, {"friction_angle": 23.40}, "slides"),
        (PRESSED, {"cohesion": 1.733e6}, None),
        (PRESSED, {"cohesion": 1.731e6}, "slides"),
        (PRESSED, {"cohesion": 1e6, "friction_angle": 10.4}, None),  # 1 + 4 x 0.1835
        (PRESSED, {"cohesion": 1e6, "friction_angle": 10.3}, "slides"),  # 1 + 4 x 0.1817
        (PULLED, {}, None),
        (PULLED, {"tension": False}, "opens"),
        (PULLED, {"tensile_strength": 1.01e6, "fracture_energy": 100.0}, None),
        (PULLED, {"tensile_strength": 0.99e6, "fracture_energy": 100.0}, "opens"),
    ],
)
def test_a_joint_holds_or_fails_as_its_strength_says(stress, law, found):
    """In the plane, and in space under the same stress in the plane of its dip."""
    space = {"dimension": 3}
    keys = {"name": "joint", "dip": 30.0, "through": [0.0, 0.0]} | law
    assert beyond_strength(JointSet(**keys), InSituStress(**stress).tensor) == found
    keys |= {"dip_direction": 90.0, "through": [0.0, 0.0, 0.0]}
    beside = {"xx": stress["xx"], "yy": 9e6, "zz": stress["yy"]}
    joint = JointSet.model_validate(keys, context=space)
    stress = InSituStress.model_validate(beside, context=space)
    assert beyond_strength(joint, stress.tensor) == found


@pytest.mark.parametrize("size", [[40.0, 30.0], [40.0, 30.0, 20.0]])
def test_joints_along_a_quiet_side_soften_the_rock_beyond_it(rock_with, size):
    """lambda = mu = 20 GPa, joints 2 m apart along the bottom: 1/M = 1/60e9 + 1/(2 x 1e10) and
    1/mu = 1/20e9 + 1/(2 x 4e9), Z = sqrt(rho M) and sqrt(rho mu); in space for both S waves."""
    scene = rock_with({"dip": 0.0, "spacing": 2.0}, domain={"size": size})
    expected = np.sqrt([2600 / (1 / 60e9 + 1 / 20e9), 2600 / (1 / 20e9 + 1 / 8e9)])
    down = -np.eye(len(size))[-1:]
    found = impedances(scene, down, np.zeros_like(down), np.array([-1]))
    tensor = np.diag(np.append(np.full(len(size) - 1, expected[1]), expected[0]))
    np.testing.assert_allclose(found, [tensor], rtol=1e-12, atol=1e-9 * expected[0])


def test_a_joint_by_bandis():
    """JRC 10, JCS 100 MPa, sigma_c 150 MPa: a = 2 (0.3 - 0.1) = 0.4 mm, JCS / a = 250,
    k_ni = -7.15 + 17.5 + 5 = 15.35 MPa/mm, d_m = -0.1772 + 1.135 * 250^-0.251 = 0.10667 mm."""
    found = bandis_closure(10.0, 100e6, 150e6)
    assert found == pytest.approx((4e-4, 15.35e9, 1.06666e-4), rel=1e-5)


@pytest.mark.parametrize(
    ("roughness", "wall", "rock", "name"),
    [
        (4.9, 100e6, 150e6, "JRC"),
        (10.0, 160e6, 150e6, "JCS"),
        (10.0, 0.0, 150e6, "JCS"),
        (15.0, 22e6, 180e6, "aperture"),
    ],
)
def test_joints_beyond_what_was_measured_are_refused(roughness, wall, rock, name):
    with pytest.raises(ValueError, match=name):
        bandis_closure(roughness, wall, rock)


SQUARE = [[9.0, 9.0], [11.0, 9.0], [11.0, 11.0], [9.0, 11.0]]
CLOSES = {"joints.maximum_closure": 1e-3}
#: Twice the peak, the prestress, and the weight of the whole pillar; of a shaken base twice the
#: impedance of intact rock times the velocity, of an acceleration its integral over half a sine.
PRESSED_DOWN = {"prestress": {"normal": 3e6}, "ends": {"end": "fixed"}}
PRESSED_DOWN |= {"gravity": {"direction": [0, 1, 0], "acceleration": 10.0}}
SHAKEN = {"load.amplitude": 0.1, "load.period": 0.01, "ends": {"start": "fixed"}}
SPEED = 2 * 0.1 * np.sqrt(8.64e10 * 2400)


@pytest.mark.parametrize(
    ("changes", "stress"),
    [
        ({}, 2e6),
        (PRESSED_DOWN, 2e6 + 3e6 + 2400 * 10 * 50),
        (SHAKEN | {"load.quantity": "velocity"}, SPEED),
        (SHAKEN | {"load.quantity": "acceleration"}, SPEED * 0.01 / np.pi),
    ],
)
def test_stress_in_reach(pillar, changes, stress):
    assert stress_in_reach(pillar(**CLOSES, **changes)) == pytest.approx(stress, rel=1e-6)


@pytest.mark.parametrize(("openings", "stress"), [([], 5e6 + 2e6), ([SQUARE], 3 * 5e6 - 2e6 + 3e6)])
def test_stress_in_reach_of_a_wave_around_an_opening(rock_with, openings, stress):
    """By Kirsch s1 becomes 3 s1 - s2 at a wall, and a wave of 1 MPa 3 MPa."""
    wave = {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker", "amplitude": 1e6}
    scene = rock_with(
        {"dip": 0.0, "spacing": 2.0, "maximum_closure": 1e-3},
        domain={"size": [20.0, 20.0], "openings": openings},
        waves=[wave | {"period": 0.005}],
        boundaries={"bottom": "quiet"},
        prestress={"xx": 2e6, "yy": 5e6},
    )
    assert stress_in_reach(scene) == pytest.approx(stress, rel=1e-6)
