"""Spectra of coarse records (groundmotion-processing 532) are those of the same straight lines.

Sought at samples alone, a quarter is lost where the period is the interval of 20 Hz."""

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


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.5])
def test_a_coarse_record_has_the_spectrum_of_its_own_straight_lines(damping):
    """The same function, sampled 50 times finer, for smooth and for rough ground, and for uneven
    times, whose smallest interval decides: 4e-5 at most."""
    time = np.arange(81) / 20
    rough = np.random.default_rng(5).normal(size=81)
    grounds = [(time, values) for values in (shaken(20)[1], rough, np.eye(81)[30])]
    for times, values in (*grounds, ([0.0, 0.1, 0.4], [0.0, 1.0, 0.0])):
        fine = np.linspace(0, times[-1], 4001)
        lines = (fine, np.interp(fine, times, values))
        coarse, exact = (
            pseudo(one, PERIODS, damping=damping, quantity="acceleration")
            for one in ((times, values), lines)
        )
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
    named = f"{files['station']}:HNZ=acceleration@0"
    for source in (files["g.csv"], f"{files['g.csv']}:NS", named):
        assert pseudo(source, PERIODS) == pytest.approx(plain, rel=1e-12)
    station = pseudo(files["station"], PERIODS, quantity="acceleration")
    assert station == pytest.approx(plain, rel=1e-12)
    found = jw.response_spectrum(files["two.txt"], PERIODS).pseudo_acceleration
    assert found.dims == ("velocity_y", "axis", "period")
    assert (found.axis.values.tolist(), found.velocity_y.values.tolist()) == (["x", "y"], [7.0])
    assert found.values[0] == pytest.approx(np.outer([0.6, 0.8], plain), rel=1e-12)


def test_peaks_and_intensities_of_an_acceleration(files, caplog):
    """PPV is the vector's, from rest; the intensity of straight lines is a dt (a_0^2 + a_0 a_1 +
    a_1^2) / 3 an interval. To those of the velocity by the error of 200 samples a period. What an
    offset leaves at the end is said."""
    velocity = velocity_of(200)
    for read in (jw.ppv, jw.arias):
        found = read(files["two.txt"]).sum().item()
        assert found == pytest.approx(read(velocity).item(), rel=2e-4)
    text = files["two.txt"].read_text()
    for one, other in (("HHE", "HHZ"), ("Vel NS", "Vel EW"), ("Tran", "Radial Acceleration")):
        header = text.replace("acceleration_x@7", one).replace("acceleration_y@7", other)
        files["two.txt"].write_text(header)  # directions of one recorder
        assert jw.ppv(files["two.txt"]).item() == pytest.approx(jw.ppv(velocity).item(), rel=2e-4)
    files["two.txt"].write_text("time,stress@7,velocity@7.25\n0,9,0\n1,8,0.5\n")
    assert jw.ppv(files["two.txt"]).values.tolist() == [0.5]
    ramp = ([0.0, 1.0], [0.0, 3.0])
    intensity = jw.arias(ramp, gravity=10.0, quantity="acceleration")
    assert intensity.item() == pytest.approx(np.pi / 20 * 3.0)  # of 9 t^2
    assert jw.ppv(ramp, "acceleration").item() == pytest.approx(1.5)
    caplog.clear()
    assert jw.ppv((range(4), [1.0, 4.0, -2.0, 1.0]), "acceleration").item() == 3.5
    (line,) = caplog.messages
    assert "its integral ends at 3 m/s: an offset of 1 m/s2" in line


def test_the_name_of_a_column_tells_its_quantity(tmp_path, caplog):
    """Stress is no velocity, a unit that is not read is not taken for SI, and one of time that is
    not there is said."""
    path = tmp_path / "one.csv"
    for name in ("Acceleration", "Radial acceleration"):
        path.write_text(f"time [s],{name}\n0,0\n1,3\n2,-3\n3,0\n")
        assert jw.ppv(path).item() == pytest.approx(1.5)
    for name, words in (("stress", "must be recorded"), ("velocity@4 mm", "must be as velocity_x")):
        path.write_text(f"time [s],{name}\n0,0\n1,3\n")
        with pytest.raises(SceneError, match=words):
            jw.ppv(path)
    assert not caplog.messages
    path.write_text("time,velocity\n0,0\n1,3\n2,0\n")
    jw.arias(path)
    (line,) = caplog.messages
    assert line.endswith("one.csv: its times have no unit: steps of 1 s look like milliseconds")


def test_a_channel_beside_components_is_left_out(tmp_path, caplog):
    """A microphone of a seismograph: the peak is of the vector (3, 4, 12); a line says so."""
    time = np.arange(200) * 1e-3
    shape = np.sin(np.pi * time / time[-1]) ** 2
    header = "time,Tran [mm/s],Vert [mm/s],Long [mm/s],Mic [Pa]"
    path, table = tmp_path / "blast.csv", np.outer(shape, [3.0, 4.0, 12.0, 50.0])
    np.savetxt(path, np.column_stack([time, table]), delimiter=",", header=header, comments="")
    assert jw.ppv(path).item() == pytest.approx(13e-3 * shape.max())
    assert caplog.messages == [f"warning: {path}: left out beside components: stress of Mic"]


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


def test_a_recording_is_what_a_label_selects_with_its_sign_and_times(row, tmp_path):
    """In a table and in a result; a minus of either turns the sign, as with `compare --with`."""
    path, result, (time, (first, last)) = row
    rows = path.read_text().split("\n", 1)[1]
    (tmp_path / "other.csv").write_text(f"t0,-CH 1,CH 2\n{rows}")
    result.assign_coords(axis=["y"]).to_netcdf(tmp_path / "run.nc")
    other = f"{tmp_path / 'other.csv'}:"
    for source, expected in (
        (f"{path}:velocity@15", last),
        (f"{path}:-velocity@15 [mm/s]", -1e-3 * last),
        (f"{tmp_path / 'run.nc'}:velocity@15", last),
        (f"{tmp_path / 'run.nc'}:-velocity_y@5", -first),
        (f"{path}:velocity@5=velocity@5 [mm/s]", 1e-3 * first),
    ):
        (found,) = jw.recording(source).velocity
        np.testing.assert_allclose(found.values[:, 0], expected, rtol=1e-12)
    found = jw.recording(f"{other}t0=time [ms]")
    np.testing.assert_allclose(found.time, 1e-3 * time, rtol=1e-12)
    np.testing.assert_allclose(found.velocity[0, :, 0], -first, rtol=1e-12)
    (tmp_path / "other.csv").write_text(f"time,-CH 1,CH 2\n{rows}")
    found = jw.recording(f"{other}-CH 1=velocity@5").velocity[0, :, 0]
    np.testing.assert_allclose(found, -first, rtol=1e-12)
    for source in (f"{path}:velocity@9", f"{tmp_path / 'run.nc'}:velocity@9", f"{other}CH 3"):
        with pytest.raises(SceneError, match=r"has no column '(velocity@9|CH 3)'"):
            jw.recording(source)


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


BARE = [0.0, 1.0, 2.0]
NO_RECORDINGS = {
    "text": ("time,a [g]\n0,0\n1,high\n", {}, r"line 3: a \[g\] = 'high': must be a number"),
    "a place": ("time,velocity@1,a\n0,0,0\n1,1,1\n", {}, "places of all its columns, or of none"),
    "components": (
        "time,velocity_x@1,velocity_y@2\n0,0,0\n1,1,1\n", {}, "same components at every receiver"
    ),
    "points": (
        "time,stress_xx@[1,2],velocity_x@[1,3]\n0,0,0\n1,1,1\n", {}, "motion at the same points"
    ),
    "a name twice": ("time,a [g],a [g]\n0,0,0\n1,1,1\n", {}, "must name each column once"),
    "no motion": ("time,stress@1\n0,0\n1,1\n", {}, "velocity: or acceleration must be recorded"),
    "a sample less": ((BARE, [0.0, 1.0]), {}, r"values = '\(1, 2\)': must be \[n\]"),
    "nan": ((BARE, [0.0, np.nan, 1.0]), {}, "velocity: must be finite numbers"),
    "damping": ((BARE, [0.0, 1.0, 0.0]), {"damping": 5.0}, "damping = 5.0: must be from 0 to bel"),
    "a period": ((BARE, [0.0, 1.0, 0.0]), {"periods": [0.0]}, "periods = 0.0: must be positive"),
}  # fmt: skip


@pytest.mark.parametrize(("source", "options", "words"), NO_RECORDINGS.values(), ids=NO_RECORDINGS)
def test_what_is_no_recording_is_refused(source, options, words, tmp_path):
    if isinstance(source, str):
        (tmp_path / "a.csv").write_text(source)
        source = tmp_path / "a.csv"
    with pytest.raises(SceneError, match=words):
        jw.response_spectrum(source, **{"periods": [1.0], **options})
