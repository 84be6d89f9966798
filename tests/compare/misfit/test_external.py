"""Curves of others: read as stated, refused in one line, and put beside ours without loss."""

import json

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.schema.tables import Prestress
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import DIGITS, write_csv
from jointwave.compare.figures.receivers import curve_table, panels
from jointwave.compare.figures.tables import write_comparisons
from jointwave.compare.misfit.alignment import align_curve, distance_at
from jointwave.compare.misfit.external import doubts, read_curves
from jointwave.compare.misfit.pairs import Comparison, measure_curves
from jointwave.compare.misfit.places import Place
from jointwave.compare.runs.comparison import compare

SCENE = "guo-li-2002/fig-03"
AT_20 = Place("stress", "", (20.0,))
TIME = np.array([0.0, 1e-3, 2e-3, 4e-3])
STRESS = np.array([0.0, 1e6, -2e6, 5e5])


@pytest.fixture
def scene(pillar):
    """Return the paper's pillar for 50 ms, with stress at 20 m."""
    return pillar(time__duration=0.05)


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a file and returns its path."""

    def write(text, name="curve.csv"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def save(path, time, stress, header="time, stress@20"):
    """Write a curve in SI as others would, and return its path."""
    np.savetxt(path, np.c_[time, stress], "%.17g", ",", header=header, comments="")
    return str(path)


def sampled(scene, interval):
    """Return the exact stress of the chain at 20 m, sampled at an interval of its own."""
    record = scene.record.model_copy(update={"interval": interval})
    found = row_of_blocks.solve(scene.model_copy(update={"record": record}))
    return found.time.values, found.stress.values[0]


def the_distance(file, scene, align=False):
    """Return the one distance of a file's curve from the exact solution, and how it was laid."""
    (curves,) = read_curves([str(file)], [scene])
    results = {"lattice": row_of_blocks.solve(scene)}
    beside = align_curve(curves, scene, results, align)
    (row,) = measure_curves(beside, results)
    assert (row.pair.other, row.place) == ("lattice", AT_20)
    return row.distance, beside


READABLE = {
    "time, stress@20\n0, 0\n1e-3, 1e6\n2e-3, -2e6\n4e-3, 5e5\n": "",
    "# by hand\ntime [ms],stress@20 [MPa]\n0,0\n\n1,1 # peak\n2,-2\n4,.5\n": "",
    "Time (us);-Stress@20.0 m (kPa)\n0;0\n1000;-1e3\n2000;2000\n4000;-500\n": "",
    '"stress@20 [MPa]"\t"time [ms]"\n0\t0\n1\t1\n-2\t2\n0.5\t4\n': "",
    "0,0\n0.001,1e6\n0.002,-2e6\n0.004,5e5\n": ":stress@20",
    "\ufeff0,0\n0.001,-1\n0.002,2\n0.004,-0.5\n": ":-stress@20 [MPa]",
    "time [ms], sigma_yy [MPa]\n0,0\n1,1\n2,-2\n4,.5\n": ":stress@20",
    "time [ms], stress [MPa], force\n0,0,7\n1,1,7\n2,-2,7\n4,.5,7\n": ":stress@20",
    "time [ms], sigma, force # by hand\n0,0,7\n1,1,7\n2,-2,7\n4,.5,7\n": ":sigma=stress@20 [MPa]",
    "time [ms], CH #1 [MPa], v\n0,0,7\n1,-1,7\n2,2,7\n4,-.5,7\n": ':"CH #1"=-stress@20',
    "time [ms], a=b:c (kPa), v\n0,0,7\n1,1e3,7\n2,-2e3,7\n4,500,7\n": ":a=b:c=stress@20",
    "time [ms],CH (1),CH (2)\n0,7,0\n1,7,1\n2,7,-2\n4,7,.5\n": ":CH (2)=stress@20 [MPa]",
    "time,stress@20,v\n0,0,\n,,\n".replace(",,\n", "1e-3,1e6,3\n")
    + "1.5e-3,,4\n2e-3,-2e6,\n4e-3,5e5,\n": ":stress@20",
    "time;stress@20\n0;0\n5e-4;\n1e-3;1e6\n2e-3;-2e6\n4e-3;5e5\n": "",
    "stress@20\ttime\n0\t0\n1e6\t1e-3\n-2e6\t2e-3\n\t3e-3\n5e5\t4e-3\n": "",
    "time, stress@10, -stress@20\n0,7,0\n1e-3,7,-1e6\n2e-3,7,2e6\n4e-3,7,-5e5\n": ":stress@20",
}


@pytest.mark.parametrize(("text", "label"), READABLE.items())
def test_every_way_of_writing_a_csv_gives_the_same_curve(text, label, written, scene):
    (curves,) = read_curves([written(text) + label], [scene])
    assert curves.name == "curve.csv" and list(curves.waveforms) == [AT_20]
    np.testing.assert_allclose(curves.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(curves.waveforms[AT_20], STRESS, rtol=1e-15)


def test_columns_of_different_times_are_curves_of_their_own(written, scene):
    """Two receivers, read in turn: no sample is made up for either."""
    text = "time [ms],stress@20 [MPa],b\n0,0,\n.5,,3\n1,1,\n1.5,,4\n2,-2,5\n4,.5,6\n"
    scene = scene.model_copy(
        update={"record": scene.record.model_copy(update={"velocity": [0.25]})}
    )
    file = written(text)
    one, other = read_curves([f"{file}:stress@20", f"{file}:b=velocity@0.25 [mm/s]"], [scene])
    np.testing.assert_allclose(one.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(other.time, [5e-4, 1.5e-3, 2e-3, 4e-3], rtol=1e-15)
    np.testing.assert_allclose(
        other.waveforms[Place("velocity", "y", (0.25,))], [3e-3, 4e-3, 5e-3, 6e-3]
    )
    assert (one.name, other.name) == ("curve.csv", "curve.csv:velocity_y@0.25")


def test_a_column_of_our_own_table_is_selected_by_its_header(pillar, tmp_path):
    """Of one solution in one variant, to the table's digits; whole, the table is refused."""
    scene = pillar(time__duration=0.03)
    result = row_of_blocks.solve(scene)
    table = curve_table([Comparison(scene, {"lattice": result})])
    file = write_csv(tmp_path / "comparison.csv", table, DIGITS)
    header = next(name for name in table if "stress at y = 20 m" in name)
    (one,) = read_curves([f"{file}:{header}=stress@20"], [scene])
    ours = AT_20.waveform(result)
    np.testing.assert_allclose(one.time, result.time.values, rtol=1e-5)
    np.testing.assert_allclose(one.waveforms[AT_20], ours, rtol=1e-5, atol=1e-6 * abs(ours).max())
    with pytest.raises(SceneError, match="must be named as stress@20"):
        read_curves([str(file)], [scene])


@pytest.mark.parametrize(
    ("label", "variable"),
    [
        ("", xr.DataArray(STRESS, {"time": TIME, "stress_y": 20.0}, ["time"])),
        (
            "",
            xr.DataArray(STRESS[:, None], {"time": TIME, "stress_y": [20.0]}, ["time", "stress_y"]),
        ),
        (
            ":-stress@20",
            xr.DataArray(
                -1e-6 * STRESS,
                {"time": ("time", 1e3 * TIME, {"units": "milliseconds"}), "stress_y": 20.0},
                ["time"],
                attrs={"units": "MPa"},
            ),
        ),
    ],
)
def test_any_netcdf_with_time_and_stress_is_read(label, variable, tmp_path, scene):
    """At a receiver that was selected, or over the dimension that results have."""
    path = tmp_path / "other.nc"
    variable.rename("stress").to_netcdf(path)
    (curves,) = read_curves([f"{path}{label}"], [scene])
    np.testing.assert_allclose(curves.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(curves.waveforms[AT_20], STRESS, rtol=1e-15)


def test_result_in_space_is_its_own_curve(pillar, tmp_path):
    """Every component of every receiver, read back from a file, at no distance."""
    record = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}
    scene = pillar(load__direction=[0.6, 0.8, 0.0], **record)
    result = row_of_blocks.solve(scene)
    result.to_netcdf(tmp_path / "run.nc")
    (curves,) = read_curves([str(tmp_path / "run.nc")], [scene])
    results = {"spatial-lattice": result}
    rows = measure_curves(align_curve(curves, scene, results, align=False), results)
    motion = [q for q in ("velocity", "displacement", "rotation") if q in result]
    places = {"stress", "shear x", "shear z"} | {f"{q} {a}" for q in motion for a in "xyz"}
    assert {row.quantity for row in rows} == places
    assert [row.distance.misfit for row in rows] == [0.0] * len(places)


@pytest.mark.parametrize("ratio", [1.3, 0.7])
def test_misfit_of_the_exact_curve_is_that_of_linear_interpolation(ratio, scene, tmp_path):
    """At most h^2 / 8 max |s''| at every time, and h^2: a quarter for half the interval.

    h is the interval of whichever is finer, s'' from second differences of an 8 times finer
    sampling, which miss h^2 / 64 of it. Sampled coarser than ours, and finer.
    """
    misfits = []
    for refine in (1, 2):
        interval = scene.interval / refine
        fine = scene.model_copy(
            update={"record": scene.record.model_copy(update={"interval": interval})}
        )
        file = save(tmp_path / "curve.csv", *sampled(scene, ratio * interval))
        found, beside = the_distance(file, fine)
        h, dense = min(1.0, ratio) * interval, interval / 8
        time, stress = sampled(scene, dense)
        second = np.abs(np.diff(stress, 2)).max() / dense**2
        own = np.interp(beside.time, time, stress)
        bound = h**2 / 8 * second * np.sqrt(len(own)) / np.linalg.norm(own)
        assert beside.own_times == (ratio > 1) and 0 < found.misfit <= 1.02 * bound
        misfits.append(found.misfit)
    assert np.log2(misfits[0] / misfits[1]) == pytest.approx(2, abs=0.1)


def test_samples_at_our_own_times_are_compared_without_loss(scene, tmp_path):
    """Uneven and few, as a digitised figure has them: only the rounding of 17 digits is left."""
    time, stress = sampled(scene, scene.interval)
    few = np.unique(np.random.default_rng(5).integers(0, len(time), 60))
    found, beside = the_distance(save(tmp_path / "few.csv", time[few], stress[few]), scene)
    assert beside.own_times and len(beside.time) == len(few)
    assert found.misfit < 1e-12 and found.peak_ratio == pytest.approx(1, abs=1e-12)


def test_uneven_samples_count_by_the_time_they_stand_for():
    """||t|| / ||1|| over [0, 1] is 1 / sqrt(3), however the samples crowd; by trapezia."""
    time = np.linspace(0, 1, 400) ** 2
    found = distance_at(time, 1 + time, np.ones_like(time))
    widest = np.diff(time).max()  # the trapezoidal rule errs by h^2 / 12 max |(t^2)''|
    assert found.misfit**2 == pytest.approx(1 / 3, abs=widest**2 / 6)
    assert found.peak_ratio == 2.0


def test_prestress_does_not_dilute_a_curves_misfit(scene, tmp_path):
    """A tenth too large is 10 % off, for any static stress in the rock; the clock is found too."""
    still = scene.model_copy(update={"prestress": Prestress(normal=5e7)})
    time, stress = sampled(scene, scene.interval)
    file = save(tmp_path / "curve.csv", time + 1e-3, 5e7 + 1.1 * stress)
    found, beside = the_distance(file, still, align=True)
    assert found.misfit == pytest.approx(0.1, rel=1e-2)
    assert found.peak_ratio == pytest.approx(1.1, rel=1e-2)
    assert beside.shift.seconds == pytest.approx(-1e-3, abs=0.1 * scene.interval)


@pytest.mark.parametrize(
    ("kind", "offset"),
    [("even", 7e-7), ("even", 1000.0), ("coarse", 1.2345e-3), ("uneven", -3.3333e-3)],
)
def test_moved_clock_is_found_to_a_tenth_of_an_interval(offset, kind, scene, tmp_path):
    """Whatever fraction of a sample it is off, and for few and uneven samples too."""
    time, stress = sampled(scene, 0.8 * scene.interval)
    keep = {
        "even": np.arange(len(time)),
        "coarse": np.arange(3, len(time), 9),
        "uneven": np.unique(np.random.default_rng(7).integers(0, len(time), 150)),
    }[kind]
    file = save(tmp_path / "late.csv", time[keep] + offset, 1.5 * stress[keep])
    found, beside = the_distance(file, scene, align=True)
    assert abs(beside.shift.seconds + offset) < 0.1 * scene.interval
    assert beside.shift.onto == "lattice" and beside.shift.correlation > 0.9999
    assert found.peak_ratio == pytest.approx(1.5, rel=1e-2)  # found, not scaled away
    assert found.misfit == pytest.approx(0.5, rel=1e-2)


def test_clock_stays_where_it_is_unless_asked(scene, tmp_path):
    """The delay is in the table instead, and the part outside the overlap is stated."""
    time, stress = sampled(scene, scene.interval)
    found, beside = the_distance(save(tmp_path / "late.csv", time + 2e-3, stress), scene)
    assert beside.shift is None and found.delay == pytest.approx(2e-3, rel=1e-2)
    assert beside.outside == pytest.approx(2e-3 / 0.05, rel=1e-9)
    assert beside.time[0] == pytest.approx(2e-3) and beside.time[-1] == pytest.approx(0.05)


def test_silent_curve_has_no_clock_to_move(scene, tmp_path):
    """No wave, no correlation; said, and nothing is moved."""
    time = sampled(scene, scene.interval)[0]
    found, beside = the_distance(save(tmp_path / "zero.csv", time, 0 * time), scene, align=True)
    assert beside.shift.onto == "" and beside.shift.seconds == 0.0
    assert found.misfit == 1.0 and np.isnan(found.delay)


def test_clock_is_moved_onto_the_solution_that_fits_best(scene, tmp_path):
    """One clock for a file: the delay from the others is left in their rows."""
    ours = row_of_blocks.solve(scene)
    other = ours.copy(deep=True)
    other["stress"] = other.stress.shift(time=40, fill_value=0.0) + 1e5
    time, stress = sampled(scene, scene.interval)
    (curves,) = read_curves([save(tmp_path / "late.csv", time + 1e-3, stress)], [scene])
    beside = align_curve(curves, scene, {"dem": other, "lattice": ours}, align=True)
    assert beside.shift.onto == "lattice"
    assert beside.shift.seconds == pytest.approx(-1e-3, abs=0.1 * scene.interval)


def test_curves_are_in_table_figure_and_files(scene, tmp_path):
    """Two files of one name get different labels."""
    time, stress = sampled(scene, 4 * scene.interval)
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    one = save(tmp_path / "a" / "x$.csv", time, stress)
    columns = np.c_[time, 1.1 * stress, stress]
    two = save(tmp_path / "b" / "x$.csv", columns[:, :1], columns[:, 1:], "time,stress@20,stress@9")
    curves = read_curves([one, two], [scene])
    (line,) = doubts(curves, scene)
    assert line == f"{two}: stress@9 is at no receiver of the scene, and left out"
    found = compare(scene, curves=curves)
    rows = {(r.pair.one, r.pair.other): r.distance for r in found.rows if r.pair.one in (one, two)}
    assert len(rows) == 2 * len(found.results) and rows[one, "lattice"].misfit < 1e-12
    assert rows[two, "lattice"].misfit == pytest.approx(0.1)
    ((panel,),) = panels([found])
    assert panel.given[two].max() == pytest.approx(1.1 * stress.max())
    assert [c for c in curve_table([found]) if c.startswith(one)]
    line = draw_solutions([found]).axes[0].lines[-1]
    np.testing.assert_allclose(line.get_ydata(), 1.1e-6 * stress, rtol=1e-12)
    write_comparisons([found], tmp_path / "out")
    assert one in (tmp_path / "out" / "comparison-misfits.csv").read_text()
    assert two in (tmp_path / "out" / "comparison-alignment.csv").read_text()


def test_solution_named_file_stays_a_file(scene, tmp_path):
    """A file called dem is not the engine."""
    file = save(tmp_path / "dem", TIME, STRESS)
    (curves,) = read_curves([file], [scene])
    assert curves.name == file


def test_scene_without_the_solution_has_no_rows(scene, tmp_path):
    """Where nothing solved the scene there is nothing to hold a curve against."""
    (curves,) = read_curves([save(tmp_path / "c.csv", TIME, STRESS)], [scene])
    beside = align_curve(curves, scene, {}, align=True)
    assert measure_curves(beside, {}) == [] and Comparison(scene, besides=[beside]).rows == []


FAULTS = {
    "unsorted": (
        "time,stress@20\n0,0\n2e-3,1\n1e-3,2\n",
        "curve.csv: line 4: time = 0.001",
        "later",
    ),
    "twice": ("time,stress@20\n0,0\n1e-3,1\n1e-3,2\n", "curve.csv: line 4: time", "repeated"),
    "time nan": ("time,stress@20\n0,0\nnan,1\n1e-3,2\n", "line 3: time = 'nan'", "a number"),
    "nan": ("time,stress@20\n0,0\n1e-3,nan\n2e-3,2\n", "line 3: stress@20 = 'nan'", "a number"),
    "huge": ("time,stress@20\n0,0\n1e-3,1e31\n2e-3,2\n", "line 3: stress@20 = 1e+31", "finite"),
    "word": ("time,stress@20\n0,0\n1e-3,none\n2e-3,2\n", "line 3: stress@20 = 'none'", "number"),
    "comma": (
        "time;stress@20\n0;0\n0,001;1\n0,002;2.5\n",
        "line 4: stress@20 = '2.5'",
        "decimal comma",
    ),
    "ragged": ("time,stress@20\n0,0\n1e-3\n2e-3,2\n", "curve.csv: line 3", "2 numbers"),
    "short": ("time,stress@20\n0,0\n1e-3,1\n", "curve.csv", "at least 3 samples"),
    "empty": ("", "curve.csv", "two or more numbers"),
    "no time": ("h,stress@20,v\n0,0,0\n1,1,1\n", "header = 'h, stress@20, v'", ":h=time"),
    "one column named": ("t\n0,0\n1,1\n2,2\n", "line 2: must hold 1", "(t), not 2"),
    "no place": ("time,stress\n0,0\n1,1\n2,2\n", "curve.csv: stress", "stress@20"),
    "no header": ("0,0\n1,1\n2,2\n", "second column", "stress@20"),
    "no unit": ("time [h],stress@20\n0,0\n1,1\n2,2\n", "unit of time = 'h'", "ms"),
    "unit": ("time,stress@20 [m/s]\n0,0\n1,1\n2,2\n", "unit of stress@20 = 'm/s'", "MPa"),
    "axis": ("time,shear@20\n0,0\n1,1\n2,2\n", "shear@20", "must be named"),
    "same": ("time,stress@20,stress@20\n0,0,0\n1,1,1\n2,2,2\n", "stress@20", "once"),
    "elsewhere": ("time,stress@21\n0,0\n1,1\n2,2\n", "stress@21", "stress at 20 m"),
    "wrong unit": ("time,stress@20\n0,0\n1,1\n2,2\n", "0 to 2 s", "time [ms]"),
    "column empty": ("time,stress@20\n0,0\n1,1\n2,\n", "stress@20", "at least 3 samples, not 2"),
    "time empty": (
        "time,stress@20\n0,0\n1,1\n,2\n",
        "line 4: time = nan or empty",
        "a finite number",
    ),
    "unnamed": ("time,stress@20,CH 3\n0,0,0\n1,1,1\n2,2,2\n", "CH 3=stress@20", "holds stress@20"),
    "binary": ("time,stress@20\n0,\0\n1,1\n2,2\n", "curve.csv", "line 2"),
}


@pytest.fixture
def refused(jointwave):
    """Return a function that gives the one line that a refused command says."""

    def said(*arguments):
        out, err = jointwave(*arguments, code=2)
        assert out == "" and err.count("\n") == 1 and err.startswith("jointwave: ")
        return err

    return said


@pytest.mark.parametrize(("text", "where", "allowed"), FAULTS.values(), ids=FAULTS)
def test_fault_is_one_line_and_exit_2(text, where, allowed, written, refused):
    """File, row and requirement, before anything is solved."""
    said = refused("compare", SCENE, "--with", written(text))
    assert where in said and allowed in said and "curve.csv" in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--with", "no/such.csv"], "no/such.csv: cannot be read"),
        (["--with", "no/such.nc"], "no/such.nc: cannot be read"),
        (["--with", "."], "directory"),
        (["--with", "GOOD:strain@20"], "'strain@20' must be a label"),
        (["--with", "GOOD:stress"], "'stress' must be a label"),
        (["--with", "GOOD:CH 3"], "GOOD holds stress@20"),
        (["--with", "GOOD:CH 3=stress@20"], "'CH 3' must be a label"),
        (["--with", "GOOD:stress@20=velocity@20"], "GOOD holds stress@20"),
        (["--with", "GOOD:t=time [ms]"], "header = 'time, stress@20'"),
        (["--with", "GOOD:stress@30"], "GOOD holds stress@20; stress@30"),
        (["--with", "GOOD", "--with", "GOOD"], "once"),
        (["--align"], "--align: needs --with"),
    ],
)
def test_wrong_option_is_one_line(arguments, words, tmp_path, refused):
    good = save(tmp_path / "good.csv", TIME, STRESS)
    arguments = [a.replace("GOOD", good) for a in arguments]
    assert words.replace("GOOD", good) in refused("compare", SCENE, *arguments)


def netcdf_faults():
    """Yield datasets that are not curves, each with its error message."""
    stress = ("time", STRESS)
    yield xr.Dataset({"stress": stress}), "time"
    yield xr.Dataset({"strain": stress}, {"time": TIME}), "one or more of stress"
    yield (
        xr.Dataset({"stress": stress}, {"time": TIME[[0, 2, 1, 3]], "stress_y": 20.0}),
        "sample 2: time = 0.001",
    )
    yield xr.Dataset({"stress": stress}, {"time": TIME}), "stress: must be over time and one of"
    yield xr.Dataset({"stress": (("x", "time"), STRESS[None])}, {"time": TIME}), "stress_y"
    holes = np.where(TIME == 2e-3, np.nan, STRESS)
    receiver = {"time": TIME, "stress_y": 20.0}
    yield xr.Dataset({"stress": ("time", holes)}, receiver), "sample 2: stress@20 = nan"
    since = {"time": ("time", TIME, {"units": "seconds since 2002-01-01"})}
    yield xr.Dataset({"stress": stress}, since | {"stress_y": 20.0}), "unit of time"


@pytest.mark.parametrize(("data", "words"), list(netcdf_faults()))
def test_faulty_netcdf_is_one_line(data, words, tmp_path, refused):
    path = tmp_path / "run.nc"
    data.to_netcdf(path)
    said = refused("compare", SCENE, "--with", path)
    assert words in said and "run.nc" in said


def test_file_cut_anywhere_is_one_line(scene, tmp_path):
    """A download that stopped, at any tenth of its length; never an exception of a library."""
    whole, cut = tmp_path / "whole.nc", tmp_path / "cut.nc"
    row_of_blocks.solve(scene).to_netcdf(whole)
    content = whole.read_bytes()
    for tenth in range(10):
        cut.write_bytes(content[: len(content) * tenth // 10])
        with pytest.raises(SceneError, match=r"cut\.nc"):
            read_curves([str(cut)], [scene])


def test_command_reads_what_run_wrote(tmp_path, jointwave):
    """`run`, then `compare --with`: the same to the last bit, and said so in JSON and in words."""
    pytest.importorskip("dolfinx")
    short = [SCENE, "--variant", "", "--set", "time.duration=0.02"]
    jointwave("run", *short, "--engine", "exact", "--model", "lattice", "--out", tmp_path)
    given = ["compare", *short, "--no-spectral", "--with", tmp_path / "exact-lattice.nc"]
    (facts,) = json.loads(jointwave(*given, "--json").out)
    said = jointwave(*given, "--all").out
    rows = {r["other"]: r for r in facts["rows"] if r["one"] == "exact-lattice.nc"}
    assert rows["lattice"]["misfit"] == 0 and rows["lattice"]["kind"] == "given curves"
    assert {"dem", "continuum-jointed", "jointed-bar"} < rows.keys()
    (curve,) = facts["curves"]
    assert curve["samples"] == 401 and curve["moved by (s)"] == curve["outside"] == 0
    assert "exact-lattice.nc ~ rigid blocks " in said
