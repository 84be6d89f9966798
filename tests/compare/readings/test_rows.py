"""Speed, attenuation and dispersion between receivers, against the theory of bar and chain."""

from functools import cache

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve
from jointwave.compare.readings.attenuation import (
    quality_factor,
    transfer_function,
    wave_speed,
    waveforms,
)
from jointwave.compare.readings.dispersion import dispersion, dispersion_theory

PLACES = list(np.linspace(5.25, 20.25, 16))  # centres of blocks
PASSED = 0.048  # s; nothing is back from the end at 60 m before


@cache
def column(period=0.01, block=0.5, duration=PASSED, quality=None, **joints):
    """Return a long pillar with a row of receivers, struck at its free start."""
    return load_tables(
        {
            "title": "a row",
            "pillar": {"length": 60.0, "side": 0.5, "block": block},
            "rock": {
                "density": 2400.0,
                "p_speed": 2200.0,
                "s_speed": 800.0,
                "intact_modulus": 8.64e10,
                **({} if quality is None else {"quality_factor": quality}),
            },
            "joints": joints,
            "load": {"shape": "ricker", "amplitude": 1e6, "period": period},
            "time": {"duration": duration},
            "record": {"velocity": PLACES, "stress": [5.0, 10.0], "interval": 5e-5},
        }
    )


def test_a_row_is_its_waveforms_and_their_distances():
    result = solve("images", column())
    row = waveforms(result)
    assert row.dims == ("receiver", "time")
    assert row.distance.values == pytest.approx(np.arange(16.0))
    assert waveforms(result, "stress").distance.values.tolist() == [0.0, 5.0]
    with pytest.raises(SceneError, match="must be one of stress, velocity, displacement"):
        waveforms(result, "strain")


def test_a_row_of_points_takes_what_moves_most():
    dims, motion = ("point", "time", "axis"), np.zeros((3, 5, 2))
    motion[:, 2, 1], motion[:, 3, 0] = 1.0, 0.5
    places = {"point_x": ("point", [1.0, 1.0, 4.0]), "point_y": ("point", [0.0, 2.0, 4.0])}
    time = {"time": np.arange(5.0), "axis": ["x", "y"]}
    result = xr.Dataset({"velocity": (dims, motion)}, {**places, **time})
    assert waveforms(result).values[0].tolist() == [0, 0, 1, 0, 0]
    assert waveforms(result, axis="x").values[0].tolist() == [0, 0, 0, 0.5, 0]
    assert waveforms(result).distance.values == pytest.approx([0.0, 2.0, 5.0])


@pytest.mark.parametrize("quantity, one, other", [("velocity", 0, -1), ("stress", 0, 1)])
def test_a_bar_has_its_speed(quantity, one, other):
    found = wave_speed(solve("images", column()), one, other, quantity)
    assert found == pytest.approx(calibrate(column()).bar_speed, rel=1e-6)


def test_a_wave_that_comes_back_has_a_negative_speed():
    result = solve("images", column()).isel(time=slice(None, None, -1))
    speed = calibrate(column()).bar_speed
    assert wave_speed(result.assign_coords(time=result.time[::-1].values)) == pytest.approx(
        -speed, rel=1e-6
    )


def test_a_pure_delay_transfers_a_falling_phase():
    result = solve("images", column())
    transfer = transfer_function(result, 0, 4).sel(frequency=slice(30, 250))
    delay = 4.0 / calibrate(column()).bar_speed
    exact = np.exp(-2j * np.pi * transfer.frequency.values * delay)
    assert np.abs(transfer.values - exact).max() < 2e-3


def test_a_kelvin_voigt_bar_attenuates_by_omega_squared_eta_over_2c():
    """The next terms are 5 / 8 (omega eta)^2 of it and, of Q = 1 / (omega eta), a quarter."""
    scene = column(damping_ratio=0.05)
    p = calibrate(scene)
    found = quality_factor(solve("equivalent-bar", scene)).sel(frequency=slice(50, 200))
    omega, eta = 2 * np.pi * found.frequency.values, p.time_constant
    off = found.attenuation.values / (omega**2 * eta / (2 * p.bar_speed)) - 1
    assert off == pytest.approx(-5 / 8 * (omega * eta) ** 2, rel=0.01)
    off = found.quality.values * omega * eta - 1
    assert off == pytest.approx((omega * eta) ** 2 / 4, rel=0.01)
    theory = dispersion_theory(scene, found.frequency.values).sel(rock="bar")
    assert found.attenuation.values == pytest.approx(theory.attenuation.values, rel=1e-7)
    assert found.phase_speed.values == pytest.approx(theory.phase_speed.values, rel=1e-8)


def test_rock_of_a_quality_factor_attenuates_as_its_theory():
    """The bar of the joints' elastic compliance and of rock whose Q is 10, from records alone: they
    end in the wave's tail, which relaxation draws out, and lack 1e-4 of the amplitude, so that some
    1e-5 1/m of the attenuation over 15 m is not known."""
    scene = column(quality=10.0)
    found = quality_factor(solve("equivalent-bar", scene)).sel(frequency=slice(60, 180))
    theory = dispersion_theory(scene, found.frequency.values).sel(rock="bar")
    assert found.attenuation.values == pytest.approx(theory.attenuation.values, abs=1e-5)
    assert found.phase_speed.values == pytest.approx(theory.phase_speed.values, rel=1e-4)
    rocks = dispersion_theory(scene, [100.0]).rock.values
    assert rocks.tolist() == ["bar", "jointed rock"]


def test_rigid_blocks_disperse_as_a_chain():
    """omega = (2 c / d) sin(k d / 2), which slows the wave by 6 % at 500 Hz."""
    scene = column(period=0.004)
    p = calibrate(scene)
    found = dispersion(solve("lattice", scene)).sel(frequency=slice(60, 500))
    theory = dispersion_theory(scene, found.frequency.values).sel(rock="rigid blocks")
    k = 2 * np.pi * found.frequency.values / theory.phase_speed.values
    assert 2 * p.bar_speed / 0.5 * np.sin(k * 0.25) == pytest.approx(
        2 * np.pi * found.frequency.values, rel=1e-12
    )
    assert theory.phase_speed.values[-1] < 0.95 * p.bar_speed
    assert found.phase_speed.values == pytest.approx(theory.phase_speed.values, rel=1e-5)
    assert (found.coherence > 0.999).all() and (found.coherence < 1 + 1e-9).all()


def test_jointed_rock_disperses_as_its_joints_do():
    scene = column(period=0.004)
    found = dispersion(solve("jointed-bar", scene)).sel(frequency=slice(60, 500))
    theory = dispersion_theory(scene, found.frequency.values)
    assert found.phase_speed.values == pytest.approx(
        theory.phase_speed.sel(rock="jointed rock").values, rel=1e-5
    )


def test_all_rocks_are_the_bar_to_long_waves():
    scene = column(damping_ratio=0.05)
    found = dispersion_theory(scene, [1.0])
    assert found.phase_speed.values == pytest.approx(calibrate(scene).bar_speed, rel=1e-5)
    quality = 1 / (2 * np.pi * calibrate(scene).time_constant)
    blocks = found.quality.sel(rock=["rigid blocks", "bar"])
    assert blocks.values == pytest.approx(quality, rel=1e-4)


def test_what_comes_back_has_a_negative_wavenumber():
    result = solve("images", column())
    back = result.isel(velocity_y=slice(None, None, -1))
    turned = back.assign_coords(velocity_y=result.velocity_y.values)
    found = dispersion(turned).sel(frequency=slice(50, 200))
    assert found.phase_speed.values == pytest.approx(-calibrate(column()).bar_speed, rel=2e-6)
