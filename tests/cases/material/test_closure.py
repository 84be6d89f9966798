"""Constants of joints from roughness and strength, by hand, and the stress in reach of a scene."""

import pytest

from jointwave.cases.material.closure import bandis_closure, stress_in_reach


def test_a_joint_by_bandis():
    """JRC 10, JCS 100 MPa, sigma_c 150 MPa: a = 2 (0.3 - 0.1) = 0.4 mm, JCS / a = 250,
    k_ni = -7.15 + 17.5 + 5 = 15.35 MPa/mm, d_m = -0.1772 + 1.135 * 250^-0.251 = 0.10667 mm."""
    found = bandis_closure(10.0, 100e6, 150e6)
    assert found == pytest.approx((4e-4, 15.35e9, 1.06666e-4), rel=1e-5)


@pytest.mark.parametrize(
    "given, name",
    [
        ((4.9, 100e6, 150e6), "JRC"),
        ((10.0, 160e6, 150e6), "JCS"),
        ((15.0, 22e6, 180e6), "aperture"),
    ],
)
def test_beyond_what_was_measured(given, name):
    with pytest.raises(ValueError, match=name):
        bandis_closure(*given)


def test_stress_in_reach(scene_with):
    """Twice the peak, the prestress, and the weight of the whole pillar."""
    joints = {"joints.maximum_closure": 1e-3}
    assert stress_in_reach(scene_with(**joints)) == pytest.approx(2e6)
    pressed = {"prestress": {"normal": 3e6}, "ends": {"end": "fixed"}}
    weight = {"gravity": {"direction": [0, 1, 0], "acceleration": 10.0}}
    found = stress_in_reach(scene_with(**joints, **pressed, **weight))
    assert found == pytest.approx(2e6 + 3e6 + 2400 * 10 * 50)


def test_stress_in_reach_of_a_shaken_base(scene_with):
    """Twice the impedance of intact rock times the velocity; of an acceleration its integral."""
    shaken = {"load.quantity": "velocity", "load.amplitude": 0.1, "ends": {"start": "fixed"}}
    scene = scene_with(**{"joints.maximum_closure": 1e-3}, **shaken)
    impedance = (8.64e10 * 2400) ** 0.5
    assert stress_in_reach(scene) == pytest.approx(2 * 0.1 * impedance)
    faster = scene.model_copy(
        update={"load": scene.load.model_copy(update={"quantity": "acceleration"})}
    )
    period = scene.load.period
    assert stress_in_reach(faster) == pytest.approx(
        2 * 0.1 * impedance * period / 3.141592653589793, rel=1e-6
    )
