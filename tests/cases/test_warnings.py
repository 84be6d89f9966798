"""Warnings: each mistake by numbers derived here, and none for shipped scenes."""

from math import pi, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import gammaincinv

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.loads import LEAST_BLOCKS, SHARE, highest_frequency, shortest_wave
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.warnings import warnings
from jointwave.cases.warnings.pillar import MOST_REFLECTED
from jointwave.compare.scenes import find, shipped_files

MODULUS, DENSITY = 2400.0 * 1000.0**2, 2400.0  # a bar speed of 1000 m/s
BAR = {
    "rock": {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": 0.25},
    "load.period": 0.02,
    "record.interval": 1e-4,
}
WAVELET = {"load.shape": "ricker", "load.cycles": None}


def lines(scene, start):
    """Return the warnings that begin so."""
    return [line for line in warnings(scene) if line.startswith(start)]


@pytest.mark.parametrize(
    "path",
    [path for path in shipped_files() if path.parent.name != "hard"],
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)
def test_nothing_that_is_shipped_warns(path):
    assert [line for scene in cases.load(path) for line in warnings(scene)] == []


def test_highest_frequency_of_a_wavelet_is_that_of_its_closed_form(scene_with):
    """|S|^2 ~ f^4 exp(-2 f^2 T^2): the share below f is P(5/2, 2 f^2 T^2)."""
    scene = scene_with(**{**WAVELET, "load.period": 0.01})
    assert highest_frequency(scene) == pytest.approx(
        sqrt(gammaincinv(2.5, SHARE) / 2) / 0.01, rel=5e-3
    )


@pytest.mark.parametrize("cycles", [1, 3])
def test_highest_frequency_of_a_sine_holds_its_share(scene_with, cycles):
    """|S|^2 = (T / pi)^2 sin^2(pi n f T) / (1 - f^2 T^2)^2, of n cycles n T / 2 in all."""
    found = highest_frequency(scene_with(**{"load.period": 0.01, "load.cycles": cycles})) * 0.01

    def density(x):
        return (2 / pi * np.sin(pi * cycles * x) / (1 - x * x)) ** 2

    below = quad(density, 0, found, points=[1.0], limit=500)[0] / cycles
    assert below == pytest.approx(SHARE, abs=2e-3)


def test_highest_frequency_of_a_gabor_pulse_is_that_of_its_gaussian(scene_with):
    """|S|^2 ~ exp(-(omega - omega_0)^2 b^2), b = n T / 4; erf(1.163) = 0.9."""
    gabor = {"load.shape": "gabor", "load.period": 0.01, "load.cycles": 4}
    expected = (1 + 1.163087 / (2 * pi * 4 / 4)) / 0.01
    assert highest_frequency(scene_with(**gabor)) == pytest.approx(expected, rel=5e-3)


def test_highest_frequency_of_a_triangle_holds_its_share(scene_with):
    """As long in rise as in decay, d each: |S|^2 = d^2 sinc^4(f d), 2 d / 3 in all."""
    triangle = {"shape": "triangle", "amplitude": 1e6, "rise": 0.004, "decay": 0.004}
    found = highest_frequency(scene_with(load=triangle)) * 0.004
    below = quad(lambda x: 2 * np.sinc(x) ** 4, 0, found)[0] / (2 / 3)
    assert below == pytest.approx(SHARE, abs=2e-3)


@pytest.mark.parametrize("quantity", ["stress", "velocity", "acceleration"])
def test_highest_frequency_of_a_record_is_that_of_the_same_wave(tmp_path, scene_with, quantity):
    """A sampled sine cycle; of an acceleration, its velocity 1 - cos."""
    t = np.linspace(0.0, 0.01, 201)
    table = np.column_stack([t + 0.003, np.sin(2 * pi * t / 0.01)])
    np.savetxt(tmp_path / "load.csv", table, delimiter=",")
    start = "free" if quantity == "stress" else "fixed"
    load = {"shape": "table", "file": str(tmp_path / "load.csv"), "amplitude": 1.0}
    found = highest_frequency(
        scene_with(**{"load": load | {"quantity": quantity}, "ends.start": start})
    )
    if quantity == "acceleration":

        def density(x):  # of 1 - cos(2 pi t / T), whose energy is 3 T / 2
            return 2 * (np.sin(pi * x) / (pi * x * (1 - x * x))) ** 2

        share = quad(density, 1e-9, found * 0.01, points=[1.0], limit=500)[0] / 1.5
        assert share == pytest.approx(SHARE, abs=3e-3)
    else:
        assert found == pytest.approx(highest_frequency(scene_with(**{"load.period": 0.01})), 5e-3)


@given(amplitude=st.floats(1e-30, 1e30), sign=st.sampled_from([-1, 1]))
def test_warnings_do_not_depend_on_the_size_of_the_load(scene_with, amplitude, sign):
    changes = {"load.period": 0.001, "ends.end": "quiet", "source": None, "record.energy": False}
    found = warnings(scene_with(**changes, **{"load.amplitude": sign * amplitude}))
    found = [line for line in found if not line.startswith("load.amplitude")]  # of its unit
    assert found == warnings(scene_with(**changes)) and len(found) >= 2


@pytest.mark.parametrize("period, warned", [(0.12, False), (0.1201, True)])
def test_a_period_longer_than_the_scene(scene_with, period, warned):
    scene = scene_with(**{"load.period": period, "time.duration": 0.12})
    assert bool(lines(scene, "load.period")) == warned


@pytest.mark.parametrize("period, warned", [(0.0799, False), (0.0801, True)])
def test_a_wavelet_that_peaks_after_the_scene(scene_with, period, warned):
    shape = {**WAVELET, "load.period": period, "time.duration": 0.12}
    assert bool(lines(scene_with(**shape), "load.period")) == warned


def table(folder, times, values):
    """Return the load of a table, and the scene's own start and end of time."""
    file = folder / "load.csv"
    file.write_text("\n".join(f"{t},{p}" for t, p in zip(times, values, strict=True)))
    return {"load": {"shape": "table", "file": str(file), "amplitude": 1e6}}


def test_a_table_in_milliseconds_is_told_from_one_that_is_late(tmp_path, scene_with):
    pulse = [0, 1, 0, 0]
    late = table(tmp_path, [0.0, 0.15, 0.2, 0.3], pulse)
    (line,) = lines(scene_with(**late), "load.file")
    assert "peaks at 0.15 s" in line and "0.12 s" in line
    for duration in (0.12, 30.0):  # where the scene's own duration is in seconds, or is not
        slip = table(tmp_path, [0.0, 5.0, 10.0, 20.0], pulse) | {"record.interval": 1e-3}
        (line,) = lines(scene_with(**slip, **{"time.duration": duration}), "load.file")
        assert "look like milliseconds" in line and line.endswith("in seconds they are 0.02")
    right = table(tmp_path, [0.0, 0.005, 0.01, 0.02], pulse)
    assert not lines(scene_with(**right), "load.file")


@pytest.mark.parametrize("shape", ["axial", "shear"])
@pytest.mark.parametrize("short, warned", [(0.999, True), (1.001, False)])
def test_blocks_a_wavelength_are_those_of_the_wave_that_is_driven(scene_with, shape, short, warned):
    """Ten blocks of 0.5 m: 5 m, at 1000 m/s along the bar and 1000 / sqrt(2.5) in shear."""
    speed = 1000.0 if shape == "axial" else 1000.0 / sqrt(2 * 1.25)
    direction = {"load.direction": [1.0, 0.0, 0.0]} if shape == "shear" else {}
    unit = highest_frequency(scene_with(**{"load.period": 1.0}))  # over one period
    period = short * LEAST_BLOCKS * 0.5 * unit / speed
    scene = scene_with(**BAR | direction | {"load.period": period})
    found = shortest_wave(scene, calibrate(scene))
    assert found.blocks == pytest.approx(short * LEAST_BLOCKS)
    assert bool(lines(scene, "pillar.block")) == warned


def test_nodes_a_wavelength_count_where_elements_are_given(scene_with):
    coarse = BAR | {"load.period": 0.003}  # 500 Hz: 2 m, 4 blocks
    assert not lines(scene_with(**coarse), "numerics")
    for order, count, warned in ((1, 2, True), (1, 3, False), (2, 1, True), (2, 2, False)):
        own = {"elements_per_block": count, "order": order}
        scene = scene_with(**coarse, **{f"numerics.continuum.{k}": v for k, v in own.items()})
        assert bool(lines(scene, "numerics.continuum.elements_per_block")) == warned
        assert len(lines(scene, "pillar.block = 0.5 m gives")) == 1


def test_beyond_the_cut_off_of_the_chain(scene_with):
    """c / (pi d) = 636.6 Hz."""
    below, above = (scene_with(**BAR | {"load.period": 1.4943 / f}) for f in (620.0, 645.0))
    assert lines(below, "pillar.block = 0.5 m gives")
    assert lines(above, "pillar.block = 0.5 m: rigid blocks transmit nothing above 636.6 Hz")
    assert shortest_wave(above, calibrate(above)).reflection == 1.0


@pytest.mark.parametrize("key", ["equivalent_poisson", "intact_poisson"])
def test_negative_poisson_ratio_that_is_given(scene_with, key):
    rock = BAR["rock"] | {key: -0.1}
    assert len(lines(scene_with(**BAR | {"rock": rock}), f"rock.{key} = -0.1 is negative")) == 1


def test_negative_poisson_ratio_of_the_speeds(scene_with):
    """Of p = 1.3 s: (1.69 - 2) / (2 (1.69 - 1)) = -0.225."""
    (line,) = lines(scene_with(**{"rock.p_speed": 1040.0}), "rock.p_speed")
    assert line.endswith("negative Poisson's ratio, -0.225")
    assert not lines(scene_with(**{"rock.p_speed": 1132.0}), "rock.p_speed")


@pytest.mark.parametrize(
    "key, value, meant",
    [
        ("rock.density", 2.4, "2.4 g/cm3 is 2400 kg/m3"),
        ("rock.density", 24.0, "24 kN/m3 is 2446 kg/m3"),
        ("rock", BAR["rock"] | {"density": 2.4e6}, "2.4e+06 g/m3 is 2400 kg/m3"),
        ("rock", {"p_speed": 2.2, "s_speed": 0.8}, "2.2 km/s is 2200 m/s"),
        ("rock", {"equivalent_modulus": 4.3, "equivalent_poisson": 0.4}, "4.3 GPa is 4.3e+09 Pa"),
        ("rock", {"equivalent_modulus": 4300.0, "equivalent_poisson": 0.4}, "4300 MPa"),
        ("joints.normal_stiffness", 9.2, "9.2 GPa/m is 9.2e+09 Pa/m"),
        ("joints.normal_stiffness", 9200.0, "9200 MPa/m is 9.2e+09 Pa/m"),
        ("soft_layers", [{"y": 20.0, "spacing_stiffness": 437.5}], "437.5 MPa is 4.375e+08 Pa"),
        ("rock.intact_modulus", 8.64e16, "above rock's"),
    ],
)
def test_a_constant_in_another_unit_is_told_what_it_is_in_that_unit(scene_with, key, value, meant):
    if key == "rock":
        value = {"density": 2400.0, **value}
    changes = {key: value}
    if key.startswith("joints"):
        changes["rock"] = {"density": 2400.0, "intact_modulus": 8.64e10}
    assert any(meant in line for line in warnings(scene_with(**changes)))


def test_intact_rock_in_gigapascal_is_told_so_where_it_is_refused(scene_with):
    with pytest.raises(SceneError, match=r"86.4 GPa is 8.64e\+10 Pa$"):
        scene_with(**{"rock.intact_modulus": 86.4})


@pytest.mark.parametrize("duration, warned", [(0.0199, True), (0.0201, False)])
def test_a_receiver_that_the_wave_does_not_reach(scene_with, duration, warned):
    """20 m at 1000 m/s."""
    scene = scene_with(**BAR, **{"time.duration": duration})
    assert bool(lines(scene, "record.stress = 20 m is reached at 0.02 s")) == warned


def test_arrivals_by_what_is_driven_and_when(tmp_path, scene_with):
    """A shear wave is slower, bending is not; a wavelet and a late table begin later."""
    end = {"time.duration": 0.03, "motion.rotation": "none"}
    across = {"load.direction": [1.0, 0.0, 0.0]}
    assert lines(scene_with(**BAR, **end, **across), "record.stress = 20 m is reached at 0.0316")
    turning = end | {"motion.rotation": "small"}
    assert not lines(scene_with(**BAR, **turning, **across), "record.stress")
    wavelet = BAR | end | {**WAVELET, "load.period": 0.0156}
    assert lines(scene_with(**wavelet), "record.stress = 20 m is reached at 0.03007")
    late = BAR | end | table(tmp_path, [0.0, 0.0099, 0.015, 0.028], [0, 0, 1, 0])
    del late["load.period"]
    assert not lines(scene_with(**late), "record.stress")
    late = late | table(tmp_path, [0.0, 0.0101, 0.015, 0.028], [0, 0, 1, 0])
    assert lines(scene_with(**late), "record.stress")


def test_pulses_that_peak_after_the_end(scene_with):
    blast = {"shape": "triangle", "amplitude": 1e6, "rise": 0.2, "decay": 0.01}
    assert lines(scene_with(load=blast), "load.rise = 0.2 s is longer than the scene")
    gabor = {"load.shape": "gabor", "load.cycles": 5, "load.period": 0.02}
    assert lines(scene_with(**gabor), "load.period = 0.02 s: the wavelet peaks at 8 periods")


def test_quiet_ends_reflect_on_rigid_blocks_unless_a_source_asks_for_them(scene_with):
    """tan(k d / 4), sin(k d / 2) = pi f d / c: at 1.494 / 0.02 s = 74.7 Hz, of 1000 m/s."""
    quiet = BAR | {"ends.end": "quiet"}
    kd = 2 * np.arcsin(pi * 1.4943 / 0.02 * 0.5 / 1000.0)
    (line,) = lines(scene_with(**quiet, source=None), "ends.end = 'quiet'")
    assert f"reflects {tan(kd / 4):.2g} of the wave" in line and "'matched'" in line
    assert tan(kd / 4) > 5 * MOST_REFLECTED
    assert not lines(scene_with(**quiet), "ends")  # the paper's (9)
    assert not lines(scene_with(**BAR, **{"ends.end": "matched"}, source=None), "ends")
    slow = quiet | {"load.period": 0.12}
    assert not lines(scene_with(**slow, source=None), "ends")


def test_local_damping_under_a_load(scene_with):
    damped = {"damping": {"local": 0.8}}
    (warning,) = warnings(scene_with(**damped))
    assert warning.startswith("damping.local distorts waves")
    assert warnings(scene_with(**damped, **{"load.amplitude": 0.0})) == []
    assert warnings(scene_with()) == []


def test_a_scene_without_a_wave_is_not_warned_of_one():
    scene = cases.load_variant(
        find("beyond/cantilever-gravity"), "sudden gravity", {"time.duration": 1e-3, "source": ""}
    )
    assert warnings(scene) == []
