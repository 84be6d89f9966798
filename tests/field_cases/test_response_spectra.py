"""Spectra of coarse records (groundmotion-processing 532): the pseudo-acceleration tends to the
peak of the ground's as the period falls, and is that of the same straight lines sampled finely.
 Sought at samples alone, a quarter is lost where the period is the interval of 20 Hz.
"""

import numpy as np
import obspy
import pytest
import xarray as xr

import jointwave as jw
from jointwave.cases.errors import SceneError

PERIODS = [0.01, 0.02, 0.05, 0.13, 0.4, 1.7]


def shaken(rate, duration=4.0):
    """Return times (s) and the acceleration sin^2(pi t / 4) sin(2 pi t), m/s2, at a rate (Hz)."""
    time = np.arange(round(duration * rate) + 1) / rate
    return time, np.sin(np.pi * time / 4) ** 2 * np.sin(2 * np.pi * time)


def velocity_of(rate):
    """Return a result that moves so along y: its velocity, integrated a hundred times finer."""
    time, acceleration = shaken(100 * rate)
    mean = (acceleration[1:] + acceleration[:-1]) / 2
    velocity = np.concatenate([[0.0], np.cumsum(mean)]) / (100 * rate)
    dims = ("velocity_y", "time", "axis")
    return xr.Dataset(
        {"velocity": (dims, velocity[None, ::100, None])},
        {"time": time[::100], "velocity_y": [3.0], "axis": ["y"]},
    )


def pseudo(recording, periods, **options):
    return jw.response_spectrum(recording, periods, **options).pseudo_acceleration.values.ravel()


@pytest.mark.parametrize("rate", [20, 200])
@pytest.mark.parametrize("recorded", ["acceleration", "velocity"])
def test_pseudo_acceleration_tends_to_the_peak_of_the_ground(rate, recorded):
    """Within 0.5 % at 0.01 s; a kink of the slope b by d rings at d / (omega a), which is 1 % at
    20 Hz and 0.03 s and falls with the period."""
    if recorded == "velocity":
        recording = velocity_of(rate)
        peak = np.abs(np.diff(recording.velocity.values.ravel())).max() * rate
    else:
        recording = shaken(rate)
        peak = np.abs(recording[1]).max()
    found = pseudo(recording, [0.01, 0.003, 0.0005], quantity=recorded) / peak
    assert np.abs(found - 1).max() < 0.005 and abs(found[-1] - 1) < 0.0005


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.5])
def test_a_coarse_record_has_the_spectrum_of_its_own_straight_lines(damping):
    """The same function, sampled 50 times finer, for smooth and for rough ground: 4e-5 at most."""
    rough = np.random.default_rng(5).normal(size=81)
    for values in (shaken(20)[1], rough, np.eye(81)[30]):
        time = np.arange(81) / 20
        fine = np.linspace(0, 4, 4001)
        coarse = pseudo((time, values), PERIODS, damping=damping, quantity="acceleration")
        lines = (fine, np.interp(fine, time, values))
        exact = pseudo(lines, PERIODS, damping=damping, quantity="acceleration")
        assert coarse == pytest.approx(exact, rel=5e-5)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("period", [0.013, 0.37, 1.9])
def test_steady_ground_asks_one_plus_exp_of_a_fast_oscillator(damping, period):
    """a (1 + exp(-pi zeta / sqrt(1 - zeta^2))), half a period after it begins, whatever the rate:
    here eleven samples over a second, the peak between them."""
    time = np.arange(11) / 10
    found = pseudo((time, np.full(11, 3.0)), [period], damping=damping, quantity="acceleration")
    exact = 1 + np.exp(-np.pi * damping / np.sqrt(1 - damping**2))
    assert found == pytest.approx(3.0 * exact, rel=1e-5)


@pytest.mark.parametrize("rate", [20, 50, 200])
@pytest.mark.parametrize("recorded, lost", [("velocity", 3), ("acceleration", 2)])
def test_what_sampling_takes_from_a_resonance(rate, recorded, lost):
    """sinc(1 / n) for each of: slopes between samples, and twice for straight lines; (pi / n)^2 / 6
    each, of a sine of n samples a period that shakes an oscillator of its own period."""

    def largest(rate):
        time = np.arange(10 * rate + 1) / rate
        return pseudo((time, np.sin(2 * np.pi * time)), [1.0], quantity=recorded).item()

    assert 1 - largest(rate) / largest(4000) == pytest.approx(
        lost * (np.pi / rate) ** 2 / 6, rel=0.04
    )


def test_what_follows_the_record_counts():
    """A blow of 1 m/s2 for 1 ms, straight up and down: v / omega of an oscillator of a second."""
    found = jw.response_spectrum(([0.0, 5e-4, 1e-3], [0.0, 1.0, 0.0]), [1.0], 0.0, "acceleration")
    assert found.displacement.item() == pytest.approx(5e-4 / (2 * np.pi), rel=1e-5)


@pytest.fixture
def files(tmp_path):
    """Write the ground at 200 Hz as files of recorders; return their paths by name."""
    time, a = shaken(200)
    table = np.column_stack([1e3 * time, a / 9.80665])
    np.savetxt(tmp_path / "g.csv", table, "%.17g", ";", header="time [ms];NS [g]", comments="")
    labelled = np.column_stack([1e3 * time, 60 * a, 80 * a])
    header = "time [ms]\tacceleration_x@7 [cm/s2]\tacceleration_y@7 [cm/s2]"
    np.savetxt(tmp_path / "two.txt", labelled, "%.17g", "\t", header=header, comments="")
    trace = obspy.Trace(a, {"sampling_rate": 200.0, "channel": "HNZ"})
    trace.write(str(tmp_path / "station"), format="MSEED")
    return {path.name: path for path in tmp_path.iterdir()}


def test_files_of_recorders_are_read_like_arrays(files):
    plain = pseudo(shaken(200), PERIODS, quantity="acceleration")
    assert pseudo(files["g.csv"], PERIODS) == pytest.approx(plain, rel=1e-12)
    assert pseudo(f"{files['g.csv']}:NS", PERIODS) == pytest.approx(plain, rel=1e-12)
    named = f"{files['station']}:HNZ=acceleration@0"
    assert pseudo(named, PERIODS) == pytest.approx(plain, rel=1e-12)
    station = pseudo(files["station"], PERIODS, quantity="acceleration")
    assert station == pytest.approx(plain, rel=1e-12)
    found = jw.response_spectrum(files["two.txt"], PERIODS).pseudo_acceleration
    assert found.dims == ("velocity_y", "axis", "period") and found.axis.values.tolist() == [
        "x",
        "y",
    ]
    assert found.velocity_y.values.tolist() == [7.0]
    assert found.values[0] == pytest.approx(np.outer([0.6, 0.8], plain), rel=1e-12)


def test_peaks_and_intensities_of_an_acceleration(files):
    """PPV is the vector's, from rest; the intensity of straight lines is a dt (a_0^2 + a_0 a_1 +
    a_1^2) / 3 an interval. To those of the velocity by the error of 200 samples a period."""
    velocity = velocity_of(200)
    for read in (jw.ppv, jw.arias):
        found = read(files["two.txt"]).sum().item()
        assert found == pytest.approx(read(velocity).item(), rel=2e-4)
    ramp = ([0.0, 1.0], [0.0, 3.0])
    intensity = jw.arias(ramp, gravity=10.0, quantity="acceleration")
    assert intensity.item() == pytest.approx(np.pi / 20 * 3.0)  # of 9 t^2
    assert jw.ppv(ramp, "acceleration").item() == pytest.approx(1.5)


@pytest.fixture
def row(tmp_path):
    """Write a wave at 500 m/s that loses a tenth over 10 m at two receivers; path and result."""
    time = np.arange(2000) * 1e-4
    pulse = [np.exp(-(((time - late) / 4e-3) ** 2)) for late in (0.05, 0.07)]
    table = np.column_stack([time, pulse[0], 0.9 * pulse[1]])
    path = tmp_path / "row.csv"
    np.savetxt(path, table, "%.17g", ",", header="time,velocity@5,velocity@15", comments="")
    result = jw.recording((time, [pulse[0], 0.9 * pulse[1]], [5.0, 15.0]))
    return path, result, (time, [pulse[0], 0.9 * pulse[1]])


def test_waves_between_recorders(row):
    """Speed, attenuation and phase speed, from a file, arrays with places and one array of xarray;
    where the places are not known, one line says so."""
    path, result, bare = row
    for source in (path, result, (*bare, [5.0, 15.0]), result.velocity):
        assert jw.wave_speed(source) == pytest.approx(500.0, rel=1e-6)
        found = jw.quality_factor(source).sel(frequency=slice(20, 60))
        assert found.attenuation.values == pytest.approx(-np.log(0.9) / 10, rel=1e-6)
        speed = jw.dispersion(source).phase_speed.sel(frequency=slice(10, 20)).values
        assert speed == pytest.approx(500.0, rel=1e-3)
    assert abs(jw.transfer_function(bare)[0]) == pytest.approx(0.9, rel=1e-6)
    for read in (jw.wave_speed, jw.dispersion):
        with pytest.raises(SceneError, match="places of receivers: are needed"):
            read(bare)


def test_uneven_samples_are_joined_by_straight_lines():
    """A digitised blow: up in 1 ms, down in 3; its smallest interval decides."""
    time, values = [0.0, 1e-3, 4e-3], [0.0, 1.0, 0.0]
    even = (1e-3 * np.arange(5), [0.0, 1.0, 2 / 3, 1 / 3, 0.0])
    found = (pseudo(one, PERIODS, quantity="acceleration") for one in ((time, values), even))
    assert next(found) == pytest.approx(next(found), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,a [g]\n0,0\n1,high\n", r"line 3: a \[g\] = 'high': must be a number"),
        ("time,velocity@1,a\n0,0,0\n1,1,1\n", "the places of all its columns, or of none"),
        ("time,velocity_x@1,velocity_y@2\n0,0,0\n1,1,1\n", "same components at every receiver"),
        ("time,a [g],a [g]\n0,0,0\n1,1,1\n", "must name each column once"),
        ("time,stress@1\n0,0\n1,1\n", "velocity: or acceleration must be recorded"),
    ],
)
def test_a_file_that_is_no_recording_is_refused(text, words, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(SceneError, match=words):
        jw.response_spectrum(tmp_path / "a.csv", [1.0])


@pytest.mark.parametrize(
    ("values", "options", "words"),
    [
        ([0.0, 1.0], {}, r"values = '\(1, 2\)': must be \[n\]"),
        ([0.0, np.nan, 1.0], {}, "velocity: must be finite numbers"),
        ([0.0, 1.0, 0.0], {"damping": 5.0}, "damping = 5.0: must be from 0 to below 1"),
        ([0.0, 1.0, 0.0], {"periods": [0.0]}, "periods = 0.0: must be positive"),
    ],
)
def test_numbers_that_are_no_recording_are_refused(values, options, words):
    with pytest.raises(SceneError, match=words):
        jw.response_spectrum(([0.0, 1.0, 2.0], values), **{"periods": [1.0], **options})
