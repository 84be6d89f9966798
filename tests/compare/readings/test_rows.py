"""Speed, attenuation and dispersion between receivers, against the theory of bar and chain."""

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import solve
from jointwave.compare.readings import attenuation
from jointwave.compare.readings.attenuation import quality_factor, wave_speed, waveforms
from jointwave.compare.readings.dispersion import dispersion, dispersion_theory


@pytest.fixture(scope="module")
def column(pillar):
    """Return a function that gives a pillar of 60 m that a Ricker pulse of a period (s) meets,
    until it is back from the end."""
    centres = np.linspace(5.25, 20.25, 16).tolist()  # of blocks
    record = {"velocity": centres, "stress": [5.0, 10.0], "interval": 5e-5}
    keys = {"pillar__length": 60.0, "time__duration": 0.048, "record": record}

    def made(period=0.01, **changes):
        load = {"shape": "ricker", "amplitude": 1e6, "period": period}
        return pillar(**{"load": load} | keys | changes)

    return made


@pytest.fixture(scope="module")
def bar(column):
    return solve("images", column()), calibrate(column()).bar_speed


def test_a_row_is_its_waveforms_and_their_distances(bar):
    row = waveforms(bar[0])
    assert row.dims == ("receiver", "time")
    assert row.distance.values == pytest.approx(np.arange(16.0))
    assert waveforms(bar[0], "stress").distance.values.tolist() == [0.0, 5.0]
    with pytest.raises(SceneError, match="must be one of stress, velocity, displacement"):
        waveforms(bar[0], "strain")


def test_a_row_of_points_takes_what_moves_most():
    dims, motion = ("point", "time", "axis"), np.zeros((3, 5, 2))
    motion[:, 2, 1], motion[:, 3, 0] = 1.0, 0.5
    places = {"point_x": ("point", [1.0, 1.0, 4.0]), "point_y": ("point", [0.0, 2.0, 4.0])}
    time = {"time": np.arange(5.0), "axis": ["x", "y"]}
    result = xr.Dataset({"velocity": (dims, motion)}, {**places, **time})
    assert waveforms(result).values[0].tolist() == [0, 0, 1, 0, 0]
    assert waveforms(result, axis="x").values[0].tolist() == [0, 0, 0, 0.5, 0]
    assert waveforms(result).distance.values == pytest.approx([0.0, 2.0, 5.0])


def test_a_plane_wave_has_its_speed_between_any_points_on_a_line_and_its_trace_between_others():
    """v = f(t - y / c): a line of 3-4-5 is passed at 5/4 c in whatever order its points come, and
    from (6, 0) to (3, 4) the wave takes 4 / c over 5 m."""
    c, time = 2000.0, 1e-5 * np.arange(2000)
    x, y = np.transpose([[6.0, 8.0], [3.0, 4.0], [9.0, 12.0], [6.0, 0.0]])
    at = {"point_x": ("point", x), "point_y": ("point", y)}
    wave = np.exp(-(((time - 5e-3 - y[:, None] / c) / 5e-4) ** 2))
    motion = np.stack([0 * wave, wave], axis=1)
    dims = ("point", "axis", "time")
    result = xr.Dataset({"velocity": (dims, motion)}, {**at, "time": time, "axis": ["x", "y"]})
    speeds = [wave_speed(result, *pair) for pair in ((0, 1), (1, 2), (3, 1))]
    assert speeds == pytest.approx([-1.25 * c, 1.25 * c, 1.25 * c], rel=1e-4)
    assert quality_factor(result, 1, 2).phase_speed.values == pytest.approx(1.25 * c, rel=1e-4)
    row = dispersion(result.isel(point=slice(3))).sel(frequency=slice(50, 240))
    assert row.phase_speed.values == pytest.approx(1.25 * c, rel=1e-4)
    with pytest.raises(SceneError, match="must lie on a line"):
        dispersion(result)


def test_a_bar_has_its_speed_and_what_comes_back_a_negative_one(bar):
    result, speed = bar
    assert wave_speed(result) == pytest.approx(speed, rel=1e-6)
    assert wave_speed(result, 0, 1, "stress") == pytest.approx(speed, rel=1e-6)
    turned = result.isel(time=slice(None, None, -1)).assign_coords(time=result.time.values)
    assert wave_speed(turned) == pytest.approx(-speed, rel=1e-6)
    back = result.isel(velocity_y=slice(None, None, -1))
    back = back.assign_coords(velocity_y=result.velocity_y.values)
    found = dispersion(back).sel(frequency=slice(50, 200))
    assert found.phase_speed.values == pytest.approx(-speed, rel=2e-6)


def test_a_row_tells_no_speed_of_waves_shorter_than_two_of_its_spacings(bar):
    """Every fifth receiver: from 0.95 c / 10 m on; at 150 Hz it read -3 c, all in one wave."""
    found = dispersion(bar[0].isel(velocity_y=slice(None, None, 5)))
    long, short = found.frequency < 0.094 * bar[1], found.frequency > 0.096 * bar[1]
    told = found.phase_speed[long & (found.frequency > 50)]
    assert told.values == pytest.approx(bar[1], rel=1e-3)
    assert short.any() and np.isnan(found.phase_speed[short]).all()


def test_a_wave_that_meets_two_receivers_at_once_is_infinitely_fast_along_them():
    t = np.linspace(0.0, 0.2, 201)
    both = np.tile(np.exp(-(((t - 0.05) / 0.008) ** 2)), (2, 1))
    assert wave_speed((t, both, [0.0, 10.0])) == np.inf


def test_a_pure_delay_transfers_a_falling_phase(bar):
    transfer = attenuation.transfer_function(bar[0], 0, 4).sel(frequency=slice(30, 250))
    exact = np.exp(-2j * np.pi * transfer.frequency.values * 4.0 / bar[1])
    assert np.abs(transfer.values - exact).max() < 2e-3


def test_a_kelvin_voigt_bar_attenuates_by_omega_squared_eta_over_2c(column):
    """The next terms are 5 / 8 (omega eta)^2 of it and, of Q = 1 / (omega eta), a quarter. To long
    waves blocks are the bar."""
    scene = column(joints__damping_ratio=0.05)
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
    long = dispersion_theory(scene, [1.0])
    assert long.phase_speed.values == pytest.approx(p.bar_speed, rel=1e-5)
    blocks = long.quality.sel(rock=["rigid blocks", "bar"])
    assert blocks.values == pytest.approx(1 / (2 * np.pi * eta), rel=1e-4)


def test_rock_of_a_quality_factor_attenuates_as_its_theory(column):
    """The bar of the joints' elastic compliance and of rock whose Q is 10, from records alone: they
    end in the wave's tail, which relaxation draws out, and lack 1e-4 of the amplitude, so that some
    1e-5 1/m of the attenuation over 15 m is not known."""
    scene = column(rock__quality_factor=10.0)
    found = quality_factor(solve("equivalent-bar", scene)).sel(frequency=slice(60, 180))
    theory = dispersion_theory(scene, found.frequency.values)
    assert theory.rock.values.tolist() == ["bar", "jointed rock"]
    theory = theory.sel(rock="bar")
    assert found.attenuation.values == pytest.approx(theory.attenuation.values, abs=1e-5)
    assert found.phase_speed.values == pytest.approx(theory.phase_speed.values, rel=1e-4)


def test_phases_are_followed_over_more_than_a_turn():
    """Rock of Q = 8 over 400 m, ten waves: speeds at 20 to 90 Hz differ by 6 %, and the phase of
    the slowest lags behind the loudest by more than half a turn."""
    time, gamma = 1e-4 * np.arange(2**14), np.arctan(1 / 8) / np.pi
    s = 2j * np.pi * np.fft.rfftfreq(len(time), 1e-4)[1:]
    arg = (np.pi * (time - 0.03) / 0.02) ** 2
    first, k = (1 - 2 * arg) * np.exp(-arg), s / (2000.0 * (s / (100 * np.pi)) ** gamma)
    last = np.fft.irfft(np.append(0.0, np.fft.rfft(first)[1:] * np.exp(-k * 400.0)))
    found = quality_factor((time, [first, last], [0.0, 400.0])).sel(frequency=slice(20, 90))
    k = np.interp(found.frequency.values, s.imag / (2 * np.pi), k.imag)
    exact = 2 * np.pi * found.frequency.values / k
    assert found.phase_speed.values == pytest.approx(exact, rel=1e-4)
    assert found.quality.values == pytest.approx(8.0, rel=0.01)


def test_damping_by_mass_attenuates_as_its_theory(column):
    """By alpha / 2 c at every frequency of a long wave: in a bar k^2 = (omega^2 - i alpha omega) /
    c^2."""
    scene = column(damping__mass_proportional=40.0)
    found = quality_factor(solve("lattice", scene)).sel(frequency=slice(60, 180))
    theory = dispersion_theory(scene, found.frequency.values)
    blocks = theory.sel(rock="rigid blocks")
    assert found.attenuation.values == pytest.approx(blocks.attenuation.values, rel=2e-3)
    assert found.phase_speed.values == pytest.approx(blocks.phase_speed.values, rel=1e-4)
    omega, c = 2 * np.pi * found.frequency.values, calibrate(scene).bar_speed
    k = np.sqrt(omega**2 - 40j * omega) / c
    assert theory.attenuation.sel(rock="bar").values == pytest.approx(-k.imag, rel=1e-12)
    slow = dispersion_theory(scene, [5.0])
    for numbers in (slow.attenuation.values.ravel(), slow.phase_speed.values.ravel()):
        assert numbers == pytest.approx(numbers[0], rel=1e-4)


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"load": {"shape": "step", "amplitude": 1e6, "direction": [1, 0, 0]}}, "load: .* axis"),
        ({"damping": {"local": 0.1}}, "damping.local: is not linear"),
        ({"joints": {"maximum_closure": 1e-4}}, "depends on stress"),
        ({"scatter": {"spacing": 0.1, "seed": 1}}, "scatter: random joints"),
    ],
)
def test_what_has_no_theory_of_dispersion_is_refused(column, changes, words):
    with pytest.raises(SceneError, match=words):
        dispersion_theory(column(**changes), [50.0])


def test_a_theory_of_dispersion_is_of_one_frequency_or_several_above_zero(column):
    one = dispersion_theory(column(), 50.0)
    assert one.equals(dispersion_theory(column(), [20.0, 50.0]).isel(frequency=[1]))
    with pytest.raises(SceneError, match=r"frequency = 0\.0: must be positive"):
        dispersion_theory(column(), [0.0, 50.0])


@pytest.mark.parametrize(
    "solver, rock", [("lattice", "rigid blocks"), ("jointed-bar", "jointed rock")]
)
def test_waves_disperse_as_theory_has_it(column, solver, rock):
    """Of a chain omega = (2 c / d) sin(k d / 2), which slows the wave by 6 % at 500 Hz."""
    scene = column(period=0.004)
    found = dispersion(solve(solver, scene)).sel(frequency=slice(60, 500))
    theory = dispersion_theory(scene, found.frequency.values)
    speed = theory.phase_speed.sel(rock=rock).values
    assert found.phase_speed.values == pytest.approx(speed, rel=1e-5)
    assert (found.coherence > 0.999).all() and (found.coherence < 1 + 1e-9).all()
    if rock == "rigid blocks":
        c, omega = calibrate(scene).bar_speed, 2 * np.pi * found.frequency.values
        assert 2 * c / 0.5 * np.sin(omega / speed * 0.25) == pytest.approx(omega, rel=1e-12)
        assert speed[-1] < 0.95 * c
