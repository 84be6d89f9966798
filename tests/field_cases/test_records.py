"""Files of other people: one table in every dialect, by a load and by `--with`, the same numbers.

Loggers and spreadsheets write semicolons, decimal commas, rows of units and lines above; a SAC file
had DELTA = 40, its rate, and B undefined (obspy 80), another 450,000 samples (obspy 363). What is
read is what the file says, and what is not read is refused with its cause."""

import io
import struct

import numpy as np
import obspy
import pytest

import jointwave
from jointwave.cases.errors import SceneError
from jointwave.cases.records import read_columns, read_history
from jointwave.cases.units import split_unit
from jointwave.cases.warnings import warnings
from jointwave.compare.figures.drawing.scene import scene_figure
from jointwave.compare.misfit.external import read_curves
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.studies.fit_keys import unit_of
from tests.field_cases.scenes import mass

TIMES = np.array([0.0, 0.1, 0.25, 0.7, 1.0, 20.0]) * 1e-3
VALUES = np.array([0.0, 1.5e6, -2.25e6, 3.3e5, 1.0, 0.0])

#: How a table is written: separator, decimal mark, units of time and stress, what stands above the
#: numbers, and what a row looks like.
SI = "time{}stress@20\n"
SEEN = "{}stress@20 [MPa]\n"
LOGGER = "Logger 7\nDate;3. May\nRate;1000 Hz\n"
DIALECTS = {
    "comma": (",", ".", 1, 1, SI),
    "comma and blank": (", ", ".", 1, 1, SI),
    "semicolon": (";", ".", 1, 1, SI),
    "tab": ("\t", ".", 1, 1, SI),
    "blanks": ("   ", ".", 1, 1, "  time   stress@20\n"),
    "decimal commas": (";", ",", 1, 1, SI),
    "decimal commas and tabs": ("\t", ",", 1, 1, SI),
    "decimal commas and blanks": ("  ", ",", 1, 1, SI),
    "brackets": (",", ".", 1e3, 1e-6, "time [ms]{}stress@20 [MPa]\n"),
    "parentheses": (",", ".", 1e6, 1e-3, "Time (µs){}stress@20 (kPa)\n"),
    "units after a comma": (";", ".", 1e3, 1e-6, "time, ms{}stress@20, MPa\n"),
    "units in cells of their own": (",", ".", 1e3, 1e-6, "time,ms,stress@20,MPa\n"),
    "units after a slash": (";", ".", 1e3, 1e-6, "t / ms{}stress@20 / MPa\n"),
    "a row of units": (";", ",", 1e3, 1e-6, "time{0}stress@20\nms{0}MPa\n"),
    "a row of units in brackets": ("\t", ".", 1e3, 1e-6, "time{0}stress@20\n[ms]{0}[MPa]\n"),
    "blanks and units": (" ", ".", 1e3, 1e-6, "time [ms] stress@20 [MPa]\n"),
    "a header that is a comment": (" ", ".", 1e3, 1e-6, "# time [ms] stress@20 [MPa]\n"),
    "five lines above": (";", ",", 1e3, 1e-6, f"{LOGGER}Gauge;A 1;[mV]\ntime [ms]{SEEN}"),
    "six lines above, with units": (
        ";", ",", 1e3, 1e-6, LOGGER + "\ntime{0}stress@20\nms{0}MPa\n"
    ),
    "comments": (",", ".", 1, 1, "# a blow of 4 ms, drawn by hand\n\n" + SI),
    "times last": (",", ".", 1, 1, "stress@20{}time\n"),
    "quoted": (";", ",", 1e3, 1e-6, '"time [ms]"{}"stress@20 [MPa]"\n'),
    "tension positive": (",", ".", 1, -1, "time{}-stress@20\n"),
}  # fmt: skip
ENCODINGS = {"utf-8": "\n", "utf-8-sig": "\r\n", "utf-16": "\r"}


def table(dialect, end="\n"):
    """Return the table as text; 17 digits, so that no number is rounded."""
    separator, decimal, times, values, header = DIALECTS[dialect]
    quote = '"' if dialect == "quoted" else ""
    text = header.format(separator)
    for row in zip(times * TIMES, values * VALUES, strict=True):
        row = reversed(row) if dialect == "times last" else row
        cells = (quote + f"{x:.17g}".replace(".", decimal) + quote for x in row)
        text += separator.join(cells) + ("  # a comment" if dialect == "comments" else "") + "\n"
    return text.replace("\n", end)


@pytest.fixture
def pillar_with(pillar):
    """Return a function of a file that gives a pillar whose load it is."""

    def scene(file, **more):
        load = {"shape": "table", "amplitude": 1.0, "file": str(file)}
        return pillar(load=load, time__duration=0.05, record__interval=1e-4, **more)

    return scene


def both_refuse(path, words, pillar_with):
    """Assert that a load and `--with` refuse a file with the same line, and return it."""
    with pytest.raises(SceneError, match=words) as load:
        pillar_with(path)
    with pytest.raises(SceneError, match=words) as curve:
        read_curves([f"{path}:stress@20"], [])
    # A curve needs a sample more than a load.
    why = str(curve.value).removeprefix(f"{path}: ").replace("at least 3", "at least 2")
    assert str(load.value).endswith(why) and "load.file" in str(load.value) and "\n" not in why
    return why


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("dialect", DIALECTS)
def test_one_table_is_the_same_numbers_in_every_dialect_and_by_both_ways(
    dialect, encoding, tmp_path, pillar_with
):
    """Each number is its decimals times a power of ten: two roundings of at most half an ulp each,
    one of which the file holds already. Names and endings of files say nothing."""
    path = tmp_path / "record.dat"
    path.write_bytes(table(dialect, ENCODINGS[encoding]).encode(encoding))
    scene = pillar_with(path)
    load = scene.load.history
    (curves,) = read_curves([str(path)], [scene])
    (curve,) = curves.waveforms.values()
    np.testing.assert_array_equal(curves.time, load.time)
    np.testing.assert_array_equal(curve, load.stress)
    np.testing.assert_array_max_ulp(load.time, TIMES, 2)
    np.testing.assert_array_max_ulp(load.stress, VALUES, 2)


SAMPLES = [0.0, 3.0, -1.5, 0.25, 0.0]


def write_sac(path, samples, interval=0.025, **header):
    """Write a SAC file, with words of its header (delta, b, e) put in place of its own."""
    trace = obspy.Trace(np.asarray(samples, dtype=np.float32))
    trace.stats.delta = interval
    written = io.BytesIO()
    trace.write(written, format="SAC")
    content = bytearray(written.getvalue())
    for word, value in header.items():
        at = 4 * {"delta": 0, "b": 5, "e": 6}[word]
        content[at : at + 4] = struct.pack("<f", value)
    path.write_bytes(content)
    return path


def test_the_rate_in_place_of_the_interval_is_refused(tmp_path, pillar_with):
    """DELTA = 40 where E = 99.975 s and 4,000 samples give 0.025 s; B is undefined."""
    path = write_sac(tmp_path / "station", np.zeros(4000), delta=40.0, b=-12345.0)
    why = both_refuse(path, "DELTA = 40 s contradicts B = undefined", pillar_with)
    assert "E = 99.975 s" in why and "0.025 s; DELTA looks like the rate in Hz" in why


@pytest.mark.parametrize(
    ("interval", "header"),
    [
        *((0.025, {}), (0.025, {"b": -12345.0}), (0.025, {"b": 3.0, "e": 3.1})),
        *((1e-7, {}), (3.2e-6, {})),
    ],
)
def test_a_sac_file_that_agrees_with_itself_is_read(interval, header, tmp_path):
    """Also of an ultrasonic record: ObsPy rounds to a microsecond, 0.1 us to zero, 3.2 us to 3."""
    write_sac(tmp_path / "a", SAMPLES, interval, **header)
    load = read_history(tmp_path / "a", "stress")
    assert load.timed and load.time == pytest.approx(interval * np.arange(5), rel=1e-6)
    assert load.stress.tolist() == SAMPLES
    begin = header["b"] if "e" in header else 0.0  # of curves and recordings, not of loads
    time = read_columns(tmp_path / "a").time.values
    assert time == pytest.approx(begin + interval * np.arange(5), rel=1e-6)


def traces(*data, rate=500.0, later=10.0, **stats):
    """Return a stream of traces that begin one after the other."""
    start, found = obspy.UTCDateTime(2026, 1, 2), obspy.Stream()
    for i, samples in enumerate(data):
        header = {"sampling_rate": rate, "starttime": start + later * i}
        header |= {name: values[i] for name, values in stats.items()}
        found.append(obspy.Trace(np.asarray(samples, dtype=np.float32), header))
    return found


@pytest.mark.parametrize("form", ["SAC", "MSEED"])
def test_a_trace_is_a_load_and_a_curve_by_its_content(form, tmp_path, pillar_with):
    """Whatever the file is called; also counts."""
    traces(SAMPLES).write(path := str(tmp_path / "trace.csv"), format=form)
    load = pillar_with(path).load.history
    (curve,) = read_curves([f"{path}:stress@20 [kPa]"], [pillar_with(path)])
    np.testing.assert_array_equal(curve.time, load.time)
    assert load.time == pytest.approx(np.arange(5) / 500.0, rel=1e-6)
    assert load.stress.tolist() == SAMPLES
    ((values),) = curve.waveforms.values()
    assert values.tolist() == [1e3 * x for x in SAMPLES]


def test_channels_of_a_seismogram_are_chosen_by_name(tmp_path, pillar):
    stream = traces([0, 1, 2], [0, 3, 4], later=0.0, channel=["BHE", "BHZ"])
    stream.write(str(tmp_path / "a"), format="MSEED")
    scene = pillar(record__velocity=[0.25], time__duration=0.1)
    (curve,) = read_curves([f"{tmp_path / 'a'}:BHZ=-velocity@0.25 [mm/s]"], [scene])
    ((values),) = curve.waveforms.values()
    assert values.tolist() == [0.0, -3e-3, -4e-3]


#: What both ways refuse, and how.
FAULTS = {
    "times that go back": ("0;0\n0,002;1\n0,001;2\n", "line 3: time = 0.001: .* later .* 0.002"),
    "a time twice": ("time\ts\n0\t0\n1\t1\n1\t2\n", "line 4: time = 1: is repeated"),
    "text": ("time;v\n0;0\n1;high\n2;1\n", "line 3: v = 'high': must be a number"),
    "nan": ("time,v\n0,0\n1,NaN\n2,1\n", "line 3: v = 'NaN': must be a number"),
    "infinite": ("time,v\n0,0\n1,inf\n2,1\n", "line 3: v = inf: must be a finite number"),
    "both decimal marks": ("0;0\n1,5;1.000\n2,5;1\n", "line 2: value = '1.000'.* decimal comma"),
    "a cell too few": ("time v\n0 0\n1\n2 1\n", r"line 3: must hold 2 numbers \(time, v\), not 1"),
    "a cell too many": ("# made\n\ntime,v\n0,0\n1,1,1\n", "line 5: must hold 2 numbers .* not 3"),
    "a header too long": ("time,v,w\n0,0\n1,1\n2,1\n", "line 2: must hold 3 numbers .* not 2"),
    "text in the first row": ("0,none\n1,1\n2,1\n3,1\n", "line 1: 'none' is neither a number"),
    "a unit unknown": ("time;v\nms;bar\n0;0\n1;1\n", "line 2: 'bar' is neither a number"),
    "units without names": ("ms;bar\n0;0\n1;1\n2;0\n", "line 1: 'bar' is neither a number nor"),
    "exponents of Fortran": ("0.0 1D0\n1.0 2.0\n2.0 3\n", "line 1: '1D0' is neither a number"),
    "thousands": ("0;1.000,5\n1;2.000,5\n", "two or more numbers, unlike '1;2.000,5'"),
    "unit of nothing": ("# in (MPa)\n0,0\n1,1\n2,0\n", "line 1 is no header .* its unit MPa"),
    "unit of another thing": ("time,v [mm/s]\n0,0\n1,1\n2,1\n", "unit of v = 'mm/s': must be Pa"),
    "an unknown unit": ("time [h],v\n0,0\n1,1\n2,1\n", r"unit of time = 'h': must be s, ms"),
    "no numbers": ("time,v\n", "must hold rows of two or more numbers, unlike 'time,v'"),
    "one row": ("time,v\n0,0\n", "must hold at least . samples, not 1"),
}  # fmt: skip


SEISMOGRAMS = {
    "a gap": (traces([0, 1, 2], [2, 1, 0]), "one trace without gaps.*has 2 traces"),
    "nan": (traces([0.0, np.nan, 1.0]), "sample 1: 1 = nan or empty: must be a finite number"),
    "one sample": (traces([1.0]), "must hold at least . samples, not 1"),
    "other times": (
        traces([0, 1, 2], [0, 1, 2], later=0.5, channel=["A", "B"]),
        "all over the same times; has 2 traces: A, B",
    ),
}
ALL_FAULTS = FAULTS | {f"a seismogram: {name}": one for name, one in SEISMOGRAMS.items()}


@pytest.mark.parametrize("name", ALL_FAULTS)
def test_what_is_wrong_is_said_once_for_both_ways(name, tmp_path, pillar_with):
    content, words = ALL_FAULTS[name]
    if isinstance(content, str):
        (tmp_path / "a.csv").write_text(content)
    else:
        content.write(str(tmp_path / "a.csv"), format="MSEED")
    both_refuse(tmp_path / "a.csv", words, pillar_with)


def test_times_that_look_like_milliseconds_warn_both_ways(tmp_path, pillar_with, jointwave):
    """Twenty of them in a scene of 0.05 s; with the unit, or in seconds, no word."""
    rows = "\n".join(f"{t:g},{1e6 * np.sin(t):g}" for t in np.linspace(0, 20, 2001))
    path = tmp_path / "a.csv"
    for unit, said in (("", True), (" [ms]", False), (" [s]", False)):
        path.write_text(f"time{unit},stress@20\n{rows}\n")
        scene = pillar_with(path)
        assert any("look like milliseconds" in line for line in warnings(scene)) == said
        if unit != " [s]":
            options = ("guo-li-2002/fig-03", "--variant", "", "--with", path, "--dry-run")
            done = jointwave("compare", *options)
            assert ("look like milliseconds" in done.err) == said
            done = jointwave("compare", *options, "--strict", code=2 if said else 0)
            assert ("(an error by --strict)" in done.err) == said


def test_a_load_has_the_unit_of_its_quantity(tmp_path):
    (tmp_path / "a").write_text("t [ms];a [g]\n0;0\n10;0,5\n")
    load = read_history(tmp_path / "a", "acceleration")
    assert load.timed and load.time.tolist() == [0.0, 0.01]
    assert load.stress.tolist() == [0, 0.5 * 9.80665]
    with pytest.raises(ValueError, match=r"unit of a = 'g': must be m/s, cm/s"):
        read_history(tmp_path / "a", "velocity")
    (tmp_path / "a").write_text("t [ms];a [counts]\n0;0\n10;5\n")
    assert read_history(tmp_path / "a", "velocity").stress.tolist() == [0.0, 5.0]


def test_a_force_is_in_newtons_in_space_and_per_metre_in_the_plane(tmp_path, monkeypatch):
    """In the file, of a fitted amplitude, and beside the drawn pulse."""
    monkeypatch.chdir(tmp_path)
    for size, unit in (([4.0, 4.0], "N/m"), ([4.0, 4.0, 4.0], "N")):
        up, middle = [*(0.0 for _ in size[1:]), 1.0], [x / 2 for x in size]
        load = {"kind": "force", "quantity": "force", "at": middle, "direction": up}
        tables = mass(4.0, 4.0, time={"duration": 0.02}, record={"points": [middle]})
        tables |= {"domain": {"size": size}, "boundaries": {}}
        (tmp_path / "a").write_text(f"t [ms];f [k{unit}]\n0;0\n10;2,5\n")
        held = tables | {"loads": [load | {"shape": "table", "amplitude": 1.0, "file": "a"}]}
        assert jointwave.load(held).loads[0].history.stress.tolist() == [0.0, 2500.0]
        other = unit.removesuffix("/m") + "/m" * (unit == "N")
        (tmp_path / "a").write_text(f"t [ms];f [k{other}]\n0;0\n10;2,5\n")
        with pytest.raises(SceneError, match=f"'k{other}': must be {unit}, k{unit}, M{unit}"):
            jointwave.load(held)
        pulse = {"shape": "half-sine", "amplitude": 2e3, "period": 0.01}
        scene = jointwave.load(tables | {"loads": [load | pulse]})
        assert unit_of("loads.0.amplitude", scene) == unit
        axes = scene_figure("a", [Comparison(scene)]).figure.axes
        assert f"(k{unit})" in " ".join(ax.get_title("left") + ax.get_title() for ax in axes)
    assert unit_of("joints.viscosity", jointwave.load("guo-li-2002/fig-03", "")) == "Pa s/m"


def test_units_of_headers():
    for unit in ("ms", "µs", "m/s²", "kPa"):
        assert split_unit(f"v [{unit}]") == ("v", unit)
    for text in ("v, mm/s", "v mm/s", "v / mm/s", "v/mm/s", "v in mm/s", "v_mm/s"):
        assert split_unit(text) == ("v", "mm/s") and split_unit(text[:-4] + "m/s") == ("v", "m/s")
    assert split_unit("t in ms") == ("t", "ms") and split_unit("time_ms") == ("time", "ms")
    assert split_unit("gap@[20,30] [mm]") == ("gap@[20,30]", "mm")
    assert split_unit("force, kN") == ("force", "kN")
    none = ["velocity, N", "a blow of 4 ms", "traction_s@[20,20]", "velocity_x"]
    for name in (*none, "velocity at y = 20.25 m"):
        assert split_unit(name) == (name, "")


def test_numbers_of_a_bare_table_are_columns_by_number(tmp_path, pillar):
    (tmp_path / "a").write_text("0 5 1\n1e-3 5 2\n2e-3 5 3\n")
    found = read_columns(tmp_path / "a")
    assert [one.name for one in found.rest] == ["2", "3"]
    source = f"{tmp_path / 'a'}:3=stress@20"
    (curve,) = jointwave.read_curves([source], [pillar(time__duration=0.02)])
    assert next(iter(curve.waveforms.values())).tolist() == [1.0, 2.0, 3.0]


def test_a_wave_and_a_base_of_a_rock_mass_are_read_in_their_units(tmp_path, monkeypatch):
    """mm/s of a wave, and g of a base, over milliseconds; the wave's times look like none."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wave").write_text("time [ms];v [mm/s]\n0;0\n5;2\n10;0\n")
    (tmp_path / "base").write_text("time\ta\nms\tg\n0\t0\n5\t0,1\n10\t0\n")
    table = {"shape": "table", "amplitude": 1.0}
    base = {"kind": "base", "side": "bottom", "direction": [1.0, 0.0], "quantity": "acceleration"}
    entering = {"kind": "P", "direction": [0.0, 1.0], "quantity": "velocity"}
    shared = {"time": {"duration": 0.02}, "record": {"points": [[5.0, 5.0]]}}
    hit = mass(10.0, 10.0, waves=[table | entering | {"file": "wave"}], **shared)
    shaken = mass(10.0, 10.0, loads=[table | base | {"file": "base"}], **shared)
    shaken["boundaries"]["bottom"] = "fixed"
    (one,), (other,) = (jointwave.load(tables).pulses for tables in (hit, shaken))
    assert one.history.time.tolist() == other.history.time.tolist() == [0.0, 0.005, 0.01]
    assert one.history.stress.tolist() == [0.0, 0.002, 0.0]
    assert other.history.stress.tolist() == [0.0, 0.1 * 9.80665, 0.0]
    assert one.history.timed and other.history.timed
