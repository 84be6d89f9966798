"""Incident waves and the tractions that bring them in, against numbers worked out by hand."""

import numpy as np
import pytest

from jointwave.cases.incident import free_field, plane_wave, tractions

WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "step", "amplitude": 1e6}
S_WAVE = WAVE | {"kind": "S"}


@pytest.fixture
def scene(rock_with):
    """A function of a wave: rock of 2000 kg/m3 with lambda = mu = 20 GPa, 4 m by 3 m, quiet."""

    def make(wave, **tables):
        return rock_with(
            domain={"size": [4.0, 3.0]},
            rock={"density": 2000.0, "intact_modulus": 5e10, "intact_poisson": 0.25},
            waves=[wave],
            boundaries=dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
            **tables,
        )

    return make


@pytest.mark.parametrize(
    ("wave", "speed", "moves", "stress"),
    [(WAVE, np.sqrt(3e7), [0, 1], [-1 / 3, -1, 0]), (S_WAVE, np.sqrt(1e7), [-1, 0], [0, 0, 1])],
)
def test_p_waves_move_along_their_travel_and_s_waves_to_its_left(scene, wave, speed, moves, stress):
    """a = sqrt(6e10 / 2000) and sigma_xx = sigma_yy / 3, b = sqrt(2e10 / 2000)."""
    v, s = free_field(scene(wave))(np.array([[2.0, 1.5]]), np.array([0.9, 1.1]) * 1.5 / speed)
    assert not v[0, :, 0].any()
    assert v[0, :, 1] == pytest.approx(1e6 / (2000 * speed) * np.array(moves), rel=1e-12)
    assert s[0, :, 1] == pytest.approx(1e6 * np.array(stress), rel=1e-12)


def test_waves_in_rock_without_its_joints_warn(scene, caplog):
    joint = {"name": "a", "dip": 0.0, "through": [0.0, 1.0]}
    joint |= {"normal_stiffness": 2e10, "shear_stiffness": 1e10}
    free_field(scene(WAVE))
    assert not caplog.records
    free_field(scene(WAVE, joint_sets=[joint]))
    assert "as in rock without joints: jointwave.simulate takes the field" in caplog.text


def test_a_face_that_a_wave_enters_feels_twice_its_stress(scene):
    """sigma n + rho a v: both terms are the stress of the front, and cancel where it leaves."""
    own = scene(WAVE)
    wave, field = plane_wave(own, own.waves[0]), free_field(own)
    rock, times = wave.rock, np.linspace(0, 2e-3, 50)
    Z = np.tile(np.diag([rock.s_impedance, rock.p_impedance]), (2, 1, 1))
    points, normals = np.array([[1.0, 0.0], [1.0, 3.0]]), np.array([[0.0, -1.0], [0.0, 1.0]])
    found = tractions(field, points, normals, Z, times)
    assert found.values[1:, 0] == pytest.approx(np.tile([0.0, 2e6], (49, 1)), rel=1e-12)
    assert np.abs(found.values[:, 1]).max() <= 1e-9  # of 1e6 Pa: it leaves, nothing is needed
    assert found.at(times[10:20]) == pytest.approx(found.values[10:20], rel=1e-9)


def test_tractions_between_samples_are_of_fourth_order(scene):
    wave = S_WAVE | {"direction": [0.6, 0.8], "shape": "ricker", "period": 1e-3}
    field, exact_at = free_field(scene(wave)), np.linspace(1e-3, 2e-3, 777)
    at, normals, Z = np.array([[1.0, 0.0]]), np.array([[0.0, -1.0]]), np.diag([6e6, 1e7])[None]
    exact = tractions(field, at, normals, Z, exact_at).values
    errors = []
    for count in (200, 400):
        coarse = tractions(field, at, normals, Z, np.linspace(0, 4e-3, count + 1))
        errors.append(np.abs(coarse.at(exact_at) - exact).max())
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.15)
