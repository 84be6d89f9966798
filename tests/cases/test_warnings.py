"""Warnings: each mistake by numbers derived here, and none for shipped scenes."""

from math import gamma, pi, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

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
ACROSS = {"load.direction": [1.0, 0.0, 0.0]}


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


@pytest.fixture
def table(tmp_path):
    """A function of times and values: the load of a table."""

    def load(times, values, quantity="stress"):
        path = tmp_path / "load.csv"
        np.savetxt(path, np.column_stack([times, values]), delimiter=",")
        return {"shape": "table", "file": str(path), "amplitude": 1e6, "quantity": quantity}

    return load


def sine(x, cycles=1):
    return (2 / pi * np.sin(pi * cycles * x) / (1 - x * x)) ** 2 / cycles


PERIODIC = {"amplitude": 1e6, "period": 0.01}
TRIANGLE = {"shape": "triangle", "amplitude": 1e6, "rise": 0.01, "decay": 0.01}
#: The share of |S|^2 per unit of x = f T: of a Gabor pulse exp(-(omega - omega_0)^2 b^2) with
#: b = n T / 4, of a triangle sinc^4, of an acceleration that of its velocity 1 - cos(2 pi t / T).
SPECTRA = {
    "ricker": (
        PERIODIC | {"shape": "ricker"},
        lambda x: (2 * x * x) ** 1.5 * np.exp(-2 * x * x) * 4 * x / gamma(2.5),
    ),
    "sine": (PERIODIC | {"shape": "sine", "cycles": 1}, sine),
    "three cycles": (PERIODIC | {"shape": "sine", "cycles": 3}, lambda x: sine(x, 3)),
    "gabor": (
        PERIODIC | {"shape": "gabor", "cycles": 4},
        lambda x: 2 * sqrt(pi) * np.exp(-((2 * pi * (x - 1)) ** 2)),
    ),
    "triangle": (TRIANGLE, lambda x: 3 * np.sinc(x) ** 4),
    "stress": ("stress", sine),
    "velocity": ("velocity", sine),
    "acceleration": ("acceleration", lambda x: 4 / 3 * (np.sinc(x) / (1 - x * x)) ** 2),
}


@pytest.mark.parametrize(("load", "density"), SPECTRA.values(), ids=SPECTRA)
def test_highest_frequency_holds_its_share_of_the_energy(pillar, table, load, density):
    """Of every shape, and of a table of one sine cycle as stress, velocity and acceleration."""
    ends = {}
    if isinstance(load, str):
        ends = {} if load == "stress" else {"ends.start": "fixed"}
        t = np.linspace(0.0, 0.01, 201)
        load = table(t + 0.003, np.sin(2 * pi * t / 0.01), load)
    found = highest_frequency(pillar(load=load, **ends)) * 0.01
    below = quad(density, 1e-9, found, points=[1.0], limit=500)[0]
    assert below == pytest.approx(SHARE, abs=3e-3)


@given(amplitude=st.floats(1e-30, 1e30), sign=st.sampled_from([-1, 1]))
def test_warnings_do_not_depend_on_the_size_of_the_load(pillar, amplitude, sign):
    changes = {"load.period": 0.001, "ends.end": "quiet", "source": None, "record.energy": False}
    found = warnings(pillar(**changes, **{"load.amplitude": sign * amplitude}))
    found = [line for line in found if not line.startswith("load.amplitude")]  # of its unit
    assert found == warnings(pillar(**changes)) and len(found) >= 2


END = BAR | {"time.duration": 0.03, "motion.rotation": "none"}
LONG = {"time.duration": 0.12}
GABOR = {"load.shape": "gabor", "load.period": 0.02}
COARSE = BAR | {"load.period": 0.003}  # 500 Hz: 2 m, 4 blocks
ORDER, ELEMENTS = "numerics.continuum.order", "numerics.continuum.elements_per_block"
INTACT = BAR["rock"] | {"intact_modulus": 2 * MODULUS}
LOSSY = INTACT | {"quality_factor": 20.0}
#: What a line begins with: changes of the scene, a key, and its value that is wrong and the same
#: just within what is meant.
PILLARS = {
    "load.period = 0.1201 s is longer": (LONG, "load.period", 0.1201, 0.12),
    "load.period = 0.0801 s: the wavelet peaks": (WAVELET | LONG, "load.period", 0.0801, 0.0799),
    "load.period = 0.02 s: the wavelet peaks at 8 periods": (GABOR, "load.cycles", 5, 3),
    "load.rise = 0.2 s is longer than the scene": ({}, "load", TRIANGLE | {"rise": 0.2}, TRIANGLE),
    # 20 m at 1000 m/s, and at 1000 / sqrt(2.5) in shear, unless blocks turn; a wavelet begins late.
    "record.stress = 20 m is reached at 0.02 s": (BAR, "time.duration", 0.0199, 0.0201),
    "record.stress = 20 m is reached at 0.0316": (END | ACROSS, "motion.rotation", "none", "small"),
    "record.stress = 20 m is reached at 0.03007": (END | WAVELET, "load.period", 0.0156, 0.0154),
    f"{ELEMENTS} = 2, of order 1": (COARSE | {ORDER: 1}, ELEMENTS, 2, 3),
    f"{ELEMENTS} = 1, of order 2": (COARSE | {ORDER: 2}, ELEMENTS, 1, 2),
    # 150.1 Hz: ten samples are 0.67 ms apart
    "record.interval = 0.0007 s takes 9.5 samples in a period at 150.1 Hz": (
        *({"load.period": 0.01}, "record.interval", 7e-4, 6.6e-4),
    ),
    # of p = 1.3 s: (1.69 - 2) / (2 (1.69 - 1)) = -0.225
    "rock.p_speed = 1040 below sqrt(2) rock.s_speed = 800 m/s gives a negative Poisson's ratio, "
    "-0.225": ({}, "rock.p_speed", 1040.0, 1132.0),
    "rock.equivalent_poisson = -0.1 is negative": (BAR, "rock.equivalent_poisson", -0.1, 0.25),
    "rock.intact_poisson = -0.1 is negative": (
        *(BAR, "rock", BAR["rock"] | {"intact_poisson": -0.1}, BAR["rock"]),
    ),
    # Under K_n d_m the speed doubles: 1 / (4 75.1 Hz 0.5 ms/m), where a quarter period catches up.
    "load: joints that close, hardly damped, steepen its wave into a shock within 6.66 of 50 m": (
        BAR | {"joints.maximum_closure": 1e6 * 0.5 / MODULUS},
        *("joints.damping_ratio", 0.01, 0.02),
    ),
    "rock.quality_factor = 20 holds from 50 to 149 Hz and rises beyond, but the load": (
        *({"load.period": 0.01, "rock": LOSSY}, "rock.quality_band", [50.0, 149.0], [50.0, 151.0]),
    ),
    # (100 Hz / 1 Hz)^(arctan(1 / 20) / pi) = 1.076, off by a third of a per cent in such a band
    "ends.end = 'quiet' has rock's impedance at rock.reference_frequency = 1 Hz: waves of 100 Hz "
    "are 1.07": (
        {"load.period": 0.01, "rock": LOSSY, "ends": {"end": "quiet"}},
        *("rock.reference_frequency", 1.0, 50.0),
    ),
    "soft_layers[0].damping_ratio = 0.1 takes 0.5 m of intact rock for the block": (
        {
            "soft_layers": [{"y": 10.0, "normal_stiffness": 1e9, "damping_ratio": 0.1}],
            "rock": INTACT,
        },
        *("segments", [{"y": [0.0, 50.0], "joints": False}], []),
    ),
    "damping.local distorts waves": ({"damping": {"local": 0.8}}, "load.amplitude", 1e6, 0.0),
}


@pytest.mark.parametrize("start", PILLARS)
def test_a_likely_mistake_in_a_pillar_is_one_line_and_what_is_meant_none(pillar, start):
    changes, key, wrong, meant = PILLARS[start]
    scene = pillar(**changes | {key: wrong})
    assert len(lines(scene, start)) == 1, warnings(scene)
    assert not lines(pillar(**changes | {key: meant}), start.split(" ")[0])


def test_beyond_the_cut_off_of_the_chain(pillar):
    """c / (pi d) = 636.6 Hz."""
    below, above = (pillar(**BAR | {"load.period": 1.4943 / f}) for f in (620.0, 645.0))
    assert lines(below, "pillar.block = 0.5 m gives")
    assert lines(above, "pillar.block = 0.5 m: rigid blocks transmit nothing above 636.6 Hz")
    assert shortest_wave(above, calibrate(above)).reflection == 1.0


def test_a_table_in_milliseconds_is_told_from_one_that_is_late(table, pillar):
    pulse = [0, 1, 0, 0]
    late = {"load": table([0.0, 0.15, 0.2, 0.3], pulse)}
    (line,) = lines(pillar(**late), "load.file")
    assert "peaks at 0.15 s" in line and "0.12 s" in line
    for duration in (0.12, 30.0):  # where the scene's own duration is in seconds, or is not
        slip = {"load": table([0.0, 5.0, 10.0, 20.0], pulse), "record.interval": 1e-3}
        (line,) = lines(pillar(**slip, **{"time.duration": duration}), "load.file")
        assert "look like milliseconds" in line and line.endswith("in seconds they are 0.02")
    assert not lines(pillar(load=table([0.0, 0.005, 0.01, 0.02], pulse)), "load.file")


def test_a_late_table_arrives_late(table, pillar):
    bar = {key: value for key, value in END.items() if key != "load.period"}
    for begin, count in ((0.0099, 0), (0.0101, 1)):
        late = table([0.0, begin, 0.015, 0.028], [0, 0, 1, 0])
        assert len(lines(pillar(**bar, load=late), "record.stress")) == count


@pytest.mark.parametrize("direction", [{}, ACROSS], ids=["axial", "shear"])
@pytest.mark.parametrize("short, warned", [(0.999, True), (1.001, False)])
def test_blocks_a_wavelength_are_those_of_the_wave_that_is_driven(pillar, direction, short, warned):
    """Ten blocks of 0.5 m: 5 m, at 1000 m/s along the bar and 1000 / sqrt(2.5) in shear."""
    speed = 1000.0 / sqrt(2 * 1.25) if direction else 1000.0
    unit = highest_frequency(pillar(**{"load.period": 1.0}))  # over one period
    period = short * LEAST_BLOCKS * 0.5 * unit / speed
    scene = pillar(**BAR | direction | {"load.period": period})
    found = shortest_wave(scene, calibrate(scene))
    assert found.blocks == pytest.approx(short * LEAST_BLOCKS)
    assert bool(lines(scene, "pillar.block")) == warned


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
def test_a_constant_in_another_unit_is_told_what_it_is_in_that_unit(pillar, key, value, meant):
    if key == "rock":
        value = {"density": 2400.0, **value}
    changes = {key: value}
    if key.startswith("joints"):
        changes["rock"] = {"density": 2400.0, "intact_modulus": 8.64e10}
    assert any(meant in line for line in warnings(pillar(**changes)))


def test_intact_rock_in_gigapascal_is_told_so_where_it_is_refused(pillar):
    with pytest.raises(SceneError, match=r"86.4 GPa is 8.64e\+10 Pa$"):
        pillar(**{"rock.intact_modulus": 86.4})


def test_velocities_beside_ends_that_waves_deform_are_those_of_end_blocks(pillar):
    """By omega Z / k over the half block: of a wall and a free end nothing or little."""
    for changes, warned in (
        ({}, [0, 0.1]),
        ({"ends.end": "matched"}, [0, 0.1, 50]),
        ({"ends.end": "fixed"}, [0, 0.1]),
        ({"rock": BAR["rock"] | {"intact_modulus": 8.64e10}}, []),
    ):
        places = {"record.velocity": [0.0, 0.1, 0.25, 49.75, 50.0], "record.stress": []}
        found = lines(pillar(**BAR | places | changes), "record.velocity")
        said = [f"record.velocity = {y:g} m lies in the last half block" for y in warned]
        assert [line.split(" before")[0] for line in found] == said


def test_quiet_ends_reflect_on_rigid_blocks_unless_a_source_asks_for_them(pillar):
    """tan(k d / 4), sin(k d / 2) = pi f d / c: at 1.494 / 0.02 s = 74.7 Hz, of 1000 m/s."""
    quiet = BAR | {"ends.end": "quiet"}
    kd = 2 * np.arcsin(pi * 1.4943 / 0.02 * 0.5 / 1000.0)
    (line,) = lines(pillar(**quiet, source=None), "ends.end = 'quiet'")
    assert f"reflects {tan(kd / 4):.2g} of the wave" in line and "'matched'" in line
    assert tan(kd / 4) > 5 * MOST_REFLECTED
    assert not lines(pillar(**quiet), "ends")  # the paper's (9)
    assert not lines(pillar(**BAR, **{"ends.end": "matched"}, source=None), "ends")
    slow = quiet | {"load.period": 0.12}
    assert not lines(pillar(**slow, source=None), "ends")


def test_a_scene_without_a_wave_is_not_warned_of_one():
    scene = cases.load_variant(
        find("beyond/cantilever-gravity"), "sudden gravity", {"time.duration": 1e-3, "source": ""}
    )
    assert warnings(scene) == []
