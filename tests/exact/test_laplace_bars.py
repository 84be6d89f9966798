"""The Laplace bars against parallel joints, attenuation, images of other loads, and each other."""

from dataclasses import replace

import numpy as np
import pytest

from cases import Scene
from cases.calibrate import calibrate
from cases.loads import Recorded, Sine, Step
from compare.exact import equivalent_bar, images, jointed_bar, kelvin_voigt, laplace

NONE = np.zeros(0)
ROCK = laplace.Bar(1000.0, 2400.0, 4e9, 0.0, NONE, NONE, NONE, laplace.End(0.0), laplace.End(0.0))
Z = np.sqrt(2400.0 * 4e9)


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("column, ratio", list(enumerate([0.05, 0.1, 0.2])))
def test_parallel_joints_transmit_as_tabulated(count, column, ratio):
    """Cai & Zhao (2000): |T| of N joints at kappa = K/(Z omega) = 1, by spacing over
    wavelength; a wave of 1 enters the bar behind a dashpot for an end stress of 2."""
    table = {
        2: [0.7822, 0.8890, 0.9864],
        3: [0.7927, 0.9995, 0.9138],
        5: [0.9963, 0.8840, 0.9468],
    }
    omega = 100.0
    spacing = ratio * 2 * np.pi * np.sqrt(4e9 / 2400) / omega
    y, ones = 100 + spacing * np.arange(count), np.ones(count)
    bar = replace(
        ROCK,
        joint_y=y,
        joint_compliance=ones / (Z * omega),
        joint_time_constant=0 * ones,
        start=laplace.End(Z),
        end=laplace.End(Z),
    )
    stress, _ = laplace.transfer(bar, np.array([1e-9 + 1j * omega]), np.array([900.0]))
    assert abs(2 * stress[0, 0]) == pytest.approx(table[count][column], abs=5.1e-5)


def test_a_damped_wave_decays_and_disperses_as_its_wavenumber():
    """Between two receivers of a bar so long that nothing comes back: e^{-i k (y2 - y1)}."""
    omega, eta = np.array([200.0, 2000.0]), 1e-3
    bar = replace(ROCK, length=1e6, time_constant=eta)
    stress, _ = laplace.transfer(bar, 1j * omega, np.array([3.0, 10.0]))
    k = kelvin_voigt.wavenumber(omega, np.sqrt(4e9 / 2400), eta)
    assert np.allclose(stress[1] / stress[0], np.exp(-7j * k), rtol=1e-12)


def test_attenuation_is_quadratic_in_frequency_while_it_is_small():
    """About omega^2 eta / 2c, to a relative error of about (5/8)(omega eta)^2."""
    omega, c, eta = 10.0, 1350.0, 1e-4
    k = kelvin_voigt.wavenumber(omega, c, eta)
    assert -k.imag == pytest.approx(omega**2 * eta / (2 * c), rel=1e-6)
    assert omega / k.real == pytest.approx(c, rel=1e-6)


def test_a_step_and_a_record_arrive_as_images_say(misfit):
    """A triangle is smooth but for three kinks. A step is off within two fine steps, a tenth of a
    sample each, of its dozen jumps: at most 12 of 2000 samples by half of a jump, 4 %."""
    c = np.sqrt(4e9 / 2400)
    bar, times = replace(ROCK, length=60.0), np.linspace(0, 0.25, 2001)
    triangle = Recorded(np.array([0.0, 0.01, 0.04]), np.array([0.0, 1e6, 0.0]))
    for load, bound in ((triangle, 9e-5), (Step(1e6), 4e-2)):
        stress, velocity, displacement = laplace.response(bar, load, times, [21.0], [33.0])
        there, back = images.images(load.value, [21.0], times, 60.0, c)
        assert misfit(stress, there + back) < bound
        there, back = images.images(load.value, [33.0], times, 60.0, c)
        assert misfit(velocity, (there - back) / Z) < bound
        there, back = images.images(load.impulse, [33.0], times, 60.0, c)
        assert misfit(displacement, (there - back) / Z) < 9e-5


def test_the_window_and_the_steps_may_be_refined_without_effect(scene, misfit, monkeypatch):
    """Halving both the fine step and what wraps moves 99 joints' result by less than 0.009 %."""
    at = scene()
    coarse = jointed_bar.solve(at)
    monkeypatch.setattr(laplace, "STEPS_PER_PERIOD", 3200)
    monkeypatch.setattr(laplace, "TAIL", 2.5)
    fine = jointed_bar.solve(at)
    assert max(misfit(coarse, fine, k) for k in ("stress", "velocity", "displacement")) < 9e-5


def test_fine_joints_are_the_homogenised_bar(scene, misfit):
    """Joints d apart that hold a share p of the compliance slow a wave by (omega d p / c)^2 / 24,
    as cos(kd) = cos(omega d/c_0) - (omega z/2K) sin(omega d/c_0) expands. Over the 0.06 s that a
    Ricker wavelet travels here, whose omega^3 is 2.2 omega_p^3 in the mean square, that leaves
    2.2 omega_p 0.06 s (omega_p d p / c)^2 / 24 = 6.6e-4, and a quarter for half the spacing."""
    off = []
    for block in (0.25, 0.125):
        at = scene(
            pillar={"block": block},
            load={"shape": "ricker", "period": 0.04},
            record={"interval": 2e-4},
        )
        off.append(misfit(jointed_bar.solve(at), equivalent_bar.solve(at)))
    assert off[0] < 6.6e-4
    assert np.log2(off[0] / off[1]) == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize("zeta", [0.02, 0.1, 1.5])
def test_the_damped_bar_s_modes_agree(scene, misfit, zeta):
    """Both are smooth but at y = 0, where the load's kinks fall on samples: 0.009 % (`laplace`)."""
    at = scene(joints={"damping_ratio": zeta})
    modes, laplace_bar = kelvin_voigt.solve(at), equivalent_bar.solve(at)
    for variable in ("stress", "velocity", "displacement"):
        assert misfit(modes, laplace_bar, variable) < 9e-5


def test_over_and_critically_damped_modes_satisfy_their_equation():
    """q'' + eta omega^2 q' + omega^2 q = f by differences of a fine sampling, which err by
    (dt/T)^2 about 1e-6 and amplify round-off to 1e-7."""
    load, mode, t = Sine(1.0, 0.01), 900.0, np.linspace(0, 0.0099, 20_001)
    for ratio in (0.3, 1.0, 1.0 + 1e-8, 2.0):
        eta = 2 * ratio / mode
        q, rate = kelvin_voigt.response(mode, eta, load, t)
        assert np.abs(np.gradient(q, t) - rate)[2:-2].max() < 1e-6 * np.abs(rate).max()
        left = np.gradient(rate, t) + eta * mode**2 * rate + mode**2 * q
        assert np.abs(left - load.value(t))[2:-2].max() < 1e-6


def test_a_soft_layer_adds_its_excess_compliance_only(scene, soft):
    p = calibrate(scene(soft_layers=soft))
    bar = equivalent_bar.bar(scene(soft_layers=soft))
    assert np.flatnonzero(bar.joint_compliance).tolist() == [39]
    assert 1 / bar.joint_compliance[39] == pytest.approx(
        1 / (1 / p.stiffness[39] - 0.5 / p.modulus), rel=1e-12
    )
    ordinary = equivalent_bar.bar(scene(soft_layers=[{"y": 20.0}]))
    assert not ordinary.joint_compliance.any()


def test_a_recorded_load_reaches_the_scene(scene, misfit, tmp_path):
    """The same triangle through a scene: images and the Laplace bar."""
    (tmp_path / "blast.csv").write_text("0,0\n0.01,1\n0.04,0\n")
    table = scene().model_dump(exclude_none=True)
    table["load"] = {"shape": "table", "amplitude": 1e6, "file": "blast.csv"}
    at = Scene.model_validate(table, context={"folder": tmp_path})
    assert misfit(equivalent_bar.solve(at), images.solve(at)) < 9e-5
