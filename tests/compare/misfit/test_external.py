"""Curves of others: read as stated, refused in one line, and put beside ours without loss."""

import json
import re

import numpy as np
import pytest
import xarray as xr

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.cases.schema.tables import Prestress
from jointwave.compare.cli.compare import show_comparisons
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.receivers import panels
from jointwave.compare.figures.tables import write_comparisons
from jointwave.compare.misfit.alignment import align_curve, distance_at
from jointwave.compare.misfit.external import doubts, read_curves
from jointwave.compare.misfit.pairs import Comparison, measure_curves, unit_doubts
from jointwave.compare.misfit.places import Place
from jointwave.compare.runs.comparison import compare

SCENE = "guo-li-2002/fig-03"
AT_20, MOTION = Place("stress", "", (20.0,)), Place("velocity", "y", (0.25,))
TIME = np.array([0.0, 1e-3, 2e-3, 4e-3])
STRESS = np.array([0.0, 1e6, -2e6, 5e5])


@pytest.fixture
def scene(pillar):
    return pillar(time__duration=0.05)


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a file, whose lines end with `/`, and returns its path."""

    def write(text):
        path = tmp_path / "curve.csv"
        path.write_text(text.replace("/", "\n"), encoding="utf-8")
        return str(path)

    return write


def save(path, time, stress, header="time, stress@20"):
    np.savetxt(path, np.c_[time, stress], "%.17g", ",", header=header, comments="")
    return str(path)


def at_interval(scene, interval):
    record = scene.record.model_copy(update={"interval": interval})
    return scene.model_copy(update={"record": record})


def sampled(scene, interval=None):
    found = row_of_blocks.solve(at_interval(scene, interval or scene.interval))
    return found.time.values, found.stress.values[0]


def the_distance(file, scene, align=False):
    """Return the one distance of a file's curve from the exact solution, and how it was laid."""
    (curves,) = read_curves([str(file)], [scene])
    results = {"lattice": row_of_blocks.solve(scene)}
    beside = align_curve(curves, scene, results, align)
    (row,) = measure_curves(beside, results)
    assert (row.pair.other, row.place) == ("lattice", AT_20)
    return row.distance, beside


#: Files whose curve a label selects; the dialects of tables are those of `cases.records`.
READABLE = {
    "\ufeff0,0/0.001,-1/0.002,2/0.004,-0.5/": ":-stress@20 [MPa]",
    "time [ms], sigma_yy [MPa]/0,0/1,1/2,-2/4,.5/": ":stress@20",
    "time [ms], stress [MPa], force/0,0,7/1,1,7/2,-2,7/4,.5,7/": ":stress@20",
    "time [ms], CH #1 [MPa], v/0,0,7/1,-1,7/2,2,7/4,-.5,7/": ':"CH #1"=-stress@20',
    "time [ms], a=b:c (kPa), v/0,0,7/1,1e3,7/2,-2e3,7/4,500,7/": ":a=b:c=stress@20",
    "time,stress@20,v/0,0,/1e-3,1e6,3/1.5e-3,,4/2e-3,-2e6,/4e-3,5e5,/": ":stress@20",
    "stress@20\ttime/0\t0/1e6\t1e-3/-2e6\t2e-3/\t3e-3/5e5\t4e-3/": "",
    "time, stress@10, -stress@20/0,7,0/1e-3,7,-1e6/2e-3,7,2e6/4e-3,7,-5e5/": ":stress@20",
}


@pytest.mark.parametrize(("text", "label"), READABLE.items())
def test_every_way_to_select_a_column_gives_the_same_curve(text, label, written, scene):
    (curves,) = read_curves([written(text) + label], [scene])
    assert curves.name == "curve.csv" and list(curves.waveforms) == [AT_20]
    np.testing.assert_allclose(curves.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(curves.waveforms[AT_20], STRESS, rtol=1e-15)


def test_columns_of_different_times_are_curves_of_their_own(written, pillar):
    file = written("time [ms],stress@20 [MPa],b/0,0,/.5,,3/1,1,/1.5,,4/2,-2,5/4,.5,6/")
    scene = pillar(record__velocity=[0.25])
    one, other = read_curves([f"{file}:stress@20", f"{file}:b=velocity@0.25 [mm/s]"], [scene])
    np.testing.assert_allclose(one.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(other.time, [5e-4, 1.5e-3, 2e-3, 4e-3], rtol=1e-15)
    np.testing.assert_allclose(other.waveforms[MOTION], [3e-3, 4e-3, 5e-3, 6e-3])
    assert (one.name, other.name) == ("curve.csv", "curve.csv:velocity_y@0.25")


IN_MS = {"time": ("time", 1e3 * TIME, {"units": "milliseconds"}), "stress_y": 20.0}


@pytest.mark.parametrize(
    ("label", "data"),
    [
        ("", (STRESS, {"time": TIME, "stress_y": 20.0}, ["time"])),
        ("", (STRESS[:, None], {"time": TIME, "stress_y": [20.0]}, ["time", "stress_y"])),
        (":-stress@20", (-1e-6 * STRESS, IN_MS, ["time"], None, {"units": "MPa"})),
    ],
)
def test_any_netcdf_with_time_and_stress_is_read(label, data, tmp_path, scene):
    path = tmp_path / "other.nc"
    xr.DataArray(*data).rename("stress").to_netcdf(path)
    (curves,) = read_curves([f"{path}{label}"], [scene])
    np.testing.assert_allclose(curves.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(curves.waveforms[AT_20], STRESS, rtol=1e-15)


@pytest.mark.parametrize("ratio", [1.3, 0.7])
def test_misfit_of_the_exact_curve_is_that_of_linear_interpolation(ratio, scene, tmp_path):
    """At most h^2 / 8 max |s''| at every time, and h^2: a quarter for half the interval. h is the
    interval of whichever is finer, s'' from second differences of an 8 times finer sampling, which
    miss h^2 / 64 of it. Sampled coarser than ours, and finer."""
    misfits = []
    for refine in (1, 2):
        interval = scene.interval / refine
        fine = at_interval(scene, interval)
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


def test_uneven_samples_count_by_the_time_they_stand_for():
    """||t|| / ||1|| over [0, 1] is 1 / sqrt(3), however the samples crowd; by trapezia."""
    time = np.linspace(0, 1, 400) ** 2
    found = distance_at(time, 1 + time, np.ones_like(time))
    widest = np.diff(time).max()  # the trapezoidal rule errs by h^2 / 12 max |(t^2)''|
    assert found.misfit**2 == pytest.approx(1 / 3, abs=widest**2 / 6)
    assert found.peak_ratio == 2.0


@pytest.mark.parametrize(
    ("offset", "still", "count"), [(7e-7, 0.0, None), (1000.0, 0.0, None), (-3.3333e-3, 5e7, 150)]
)
def test_moved_clock_is_found_to_a_tenth_of_an_interval(offset, still, count, scene, tmp_path):
    """Whatever fraction of a sample it is off, for few and uneven samples too, and for any static
    stress in the rock, which does not dilute the misfit. Amplitudes are not scaled away."""
    if still:
        scene = scene.model_copy(update={"prestress": Prestress(normal=still)})
    time, stress = sampled(scene, 0.8 * scene.interval)
    if count is not None:
        keep = np.unique(np.random.default_rng(7).choice(np.arange(len(time)), count))
        time, stress = time[keep], stress[keep]
    late = save(tmp_path / "late.csv", time + offset, still + 1.5 * (stress - still))
    found, beside = the_distance(late, scene, True)
    assert abs(beside.shift.seconds + offset) < 0.1 * scene.interval
    assert beside.shift.onto == "lattice" and beside.shift.correlation > 0.9999
    assert found.peak_ratio == pytest.approx(1.5, rel=1e-2)
    assert found.misfit == pytest.approx(0.5, rel=1e-2)


def test_clock_stays_where_it_is_unless_asked_or_silent(scene, tmp_path):
    time, stress = sampled(scene)
    found, beside = the_distance(save(tmp_path / "late.csv", time + 2e-3, stress), scene)
    assert beside.shift is None and found.delay == pytest.approx(2e-3, rel=1e-2)
    assert beside.outside == pytest.approx(2e-3 / 0.05, rel=1e-9)
    assert beside.time[0] == pytest.approx(2e-3) and beside.time[-1] == pytest.approx(0.05)
    found, beside = the_distance(save(tmp_path / "zero.csv", time, 0 * time), scene, align=True)
    assert beside.shift.onto == "" and beside.shift.seconds == 0.0
    assert found.misfit == 1.0 and np.isnan(found.delay)


def test_clock_is_moved_onto_the_solution_that_fits_best(scene, tmp_path):
    """One clock for a file: the delay from the others is left in their rows. Where nothing solved
    the scene there is nothing to hold a curve against."""
    ours = row_of_blocks.solve(scene)
    other = ours.copy(deep=True)
    other["stress"] = other.stress.shift(time=40, fill_value=0.0) + 1e5
    time, stress = sampled(scene)
    (curves,) = read_curves([save(tmp_path / "late.csv", time + 1e-3, stress)], [scene])
    beside = align_curve(curves, scene, {"dem": other, "lattice": ours}, align=True)
    assert beside.shift.onto == "lattice"
    assert beside.shift.seconds == pytest.approx(-1e-3, abs=0.1 * scene.interval)
    assert measure_curves(align_curve(curves, scene, {}, align=True), {}) == []


def test_the_summary_says_how_far_a_clock_was_moved(scene, tmp_path, capsys):
    time, stress = sampled(scene)
    curves = read_curves([save(tmp_path / "late.csv", time + 1e-3, stress)], [scene])
    show_comparisons([compare(scene, curves, align=True)], every=False, as_json=False)
    (line,) = (x for x in capsys.readouterr().out.splitlines() if x.startswith("late.csv  base"))
    assert re.search(r"  -0.001 +rigid blocks, exact +1 *$", line)


def test_curves_are_in_table_figure_and_files(scene, tmp_path):
    time, stress = sampled(scene, 4 * scene.interval)
    for name in "ab":
        (tmp_path / name).mkdir()
    one = save(tmp_path / "a" / "x$.csv", time, stress)
    columns = np.c_[1.1 * stress, stress]
    two = save(tmp_path / "b" / "x$.csv", time, columns, "time,stress@20,stress@9")
    curves = read_curves([one, two], [scene])
    (line,) = doubts(curves, scene)
    assert line == f"{two}: stress@9 is at no receiver of the scene, and left out"
    found = compare(scene, curves=curves)
    rows = {(r.pair.one, r.pair.other): r.distance for r in found.rows if r.pair.one in (one, two)}
    assert len(rows) == 2 * len(found.results) and rows[one, "lattice"].misfit < 1e-12
    assert rows[two, "lattice"].misfit == pytest.approx(0.1)
    ((panel,),) = panels([found])
    assert panel.given[two].max() == pytest.approx(1.1 * stress.max())
    line = draw_solutions([found]).axes[0].lines[-1]
    np.testing.assert_allclose(line.get_ydata(), 1.1e-6 * stress, rtol=1e-12)
    pressed = scene.model_copy(update={"prestress": Prestress(normal=4e6)})
    (curve,) = read_curves([save(tmp_path / "total.csv", time, stress + 4e6)], [pressed])
    for drawn in draw_solutions([compare(pressed, [curve])]).axes[0].lines[1:]:
        assert np.abs(drawn.get_ydata()).max() == pytest.approx(1e-6 * np.abs(stress).max(), 0.1)
    write_comparisons([found], tmp_path / "out")
    assert one in (tmp_path / "out" / "comparison-misfits.csv").read_text()
    assert two in (tmp_path / "out" / "comparison-alignment.csv").read_text()


HEAD = "time,stress@20/"
FAULTS = [
    ("h,stress@20,v/0,0,0/1,1,1/", "header = 'h, stress@20, v'.*:h=time"),
    ("time,stress/0,0/1,1/2,2/", r"curve\.csv: stress.*stress@20"),
    ("time,stress@20,stress@20/0,0,0/1,1,1/2,2,2/", "stress@20.*once"),
    ("time,stress@21/0,0/1,1/2,2/", "stress@21.*stress at 20 m"),
    (f"{HEAD}0,0/1,1/2,2/", r"0 to 2 s.*time \[ms\]"),
    (f"{HEAD}0,0/1,1/2,/", "stress@20.*at least 3 samples, not 2"),
    (f"{HEAD}0,0/1,1/,2/", "line 4: time = nan or empty.*a finite number"),
    ("time,stress@20,CH 3/0,0,0/1,1,1/2,2,2/", "CH 3=stress@20.*holds stress@20"),
    (f"{HEAD}0,\0/1,1/2,2/", "line 2"),
]
GOOD_HOLDS = "GOOD holds stress@20"
WRONG = [
    (["no/such.csv"], "no/such.csv: cannot be read"),
    (["no/such.nc"], "no/such.nc: cannot be read"),
    (["."], "directory"),
    (["GOOD:strain@20"], "'strain@20' must be a label"),
    (["GOOD:CH 3"], GOOD_HOLDS),
    (["GOOD:stress@20=velocity@20"], GOOD_HOLDS),
    (["GOOD:t=time [ms]"], "header = 'time, stress@20'"),
    (["GOOD:stress@30"], f"{GOOD_HOLDS}; stress@30"),
    (["GOOD", "--with", "GOOD"], "once"),
]


@pytest.fixture
def refused(jointwave):
    def said(*arguments):
        out, err = jointwave("compare", SCENE, *arguments, code=2)
        assert out == "" and err.count("\n") == 1 and err.startswith("jointwave: ")
        return err

    return said


@pytest.mark.parametrize(("text", "words"), FAULTS)
def test_fault_is_one_line_and_exit_2(text, words, written, refused):
    said = refused("--with", written(text))
    assert re.search(words, said) and "curve.csv" in said


@pytest.mark.parametrize(("arguments", "words"), WRONG)
def test_wrong_option_is_one_line(arguments, words, tmp_path, refused):
    good = save(tmp_path / "good.csv", TIME, STRESS)
    arguments = [a.replace("GOOD", good) for a in arguments]
    assert words.replace("GOOD", good) in refused("--with", *arguments)


HOLES = np.where(TIME == 2e-3, np.nan, STRESS)
STAMPED = ("time", TIME, {"units": "seconds since 2002-01-01"})
RECEIVER = {"time": TIME, "stress_y": 20.0}
NO_CURVES = [
    ({"stress": ("time", STRESS)}, {}, "time"),
    ({"strain": ("time", STRESS)}, {"time": TIME}, "one or more of stress"),
    ({"stress": ("time", STRESS)}, {"time": TIME}, "stress: must be over time and one of"),
    ({"stress": (("x", "time"), STRESS[None])}, {"time": TIME}, "stress_y"),
    ({"stress": ("time", HOLES)}, RECEIVER, "sample 2: stress@20 = nan"),
    ({"stress": ("time", STRESS)}, RECEIVER | {"time": STAMPED}, "unit of time"),
]


@pytest.mark.parametrize(("fields", "coordinates", "words"), NO_CURVES)
def test_faulty_netcdf_is_one_line(fields, coordinates, words, tmp_path, refused):
    path = tmp_path / "run.nc"
    xr.Dataset(fields, coordinates).to_netcdf(path)
    said = refused("--with", path)
    assert words in said and "run.nc" in said


def test_file_cut_anywhere_is_one_line(scene, tmp_path):
    whole, cut = tmp_path / "whole.nc", tmp_path / "cut.nc"
    row_of_blocks.solve(scene).to_netcdf(whole)
    content = whole.read_bytes()
    for tenth in range(10):
        cut.write_bytes(content[: len(content) * tenth // 10])
        with pytest.raises(SceneError, match=r"cut\.nc"):
            read_curves([str(cut)], [scene])


@pytest.mark.parametrize(
    ("unit", "factor", "said"), [("", 1e-6, True), ("", 0.1, False), (" [MPa]", 1e-6, False)]
)
def test_a_curve_without_a_unit_is_doubted_where_its_size_is_another(
    unit, factor, said, scene, tmp_path
):
    time, stress = sampled(scene)
    file = save(tmp_path / "curve.csv", time, factor * stress, f"time [s], stress@20{unit}")
    results = {"lattice": row_of_blocks.solve(scene)}
    beside = align_curve(read_curves([file], [scene])[0], scene, results, False)
    found = Comparison(scene, results, {}, measure_curves(beside, results), [beside])
    lines = list(unit_doubts(found))
    assert len(lines) == said
    assert all("stress@20 has no unit" in one and "1.0e-06 times" in one for one in lines)


@pytest.mark.parametrize(("held", "said"), [(0.0, True), (5e6, False)])
def test_a_stress_without_what_is_there_at_rest_is_doubted(held, said, scene, tmp_path):
    """As a strain gauge measures it; the scene is prestressed by 5 MPa."""
    time, stress = sampled(scene)
    pressed = scene.model_copy(update={"prestress": Prestress(normal=5e6)})
    file = save(tmp_path / "curve.csv", time, held + stress)
    (line, *_) = [*unit_doubts(compare(pressed, read_curves([file], [pressed]))), ""]
    assert ("stress@20 begins at 0 Pa, the scene at 5e+06 Pa: stress is total" in line) == said


def test_command_reads_what_run_wrote(tmp_path, jointwave):
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
    assert "exact-lattice.nc ~ rigid blocks " in said and "compared from" not in said
    early = save(tmp_path / "short.csv", *2 * [np.linspace(0.0, 0.005, 9)])
    said = jointwave("compare", *short, "--no-spectral", "--with", early).out
    line = (
        "short.csv: compared from 0 to 0.005 s only, 25 % of the scene; nothing moves until then: "
    )
    assert f"{line}stress at 20 m\n" in said and "short.csv ~" not in said


def test_what_symmetry_forbids_decides_nothing(one_joint, tmp_path):
    """A P wave across a joint moves nothing along it: round-off there is no distance."""
    sides = dict.fromkeys(("left", "right"), "periodic") | dict.fromkeys(("bottom", "top"), "quiet")
    tables = one_joint(
        domain={"size": [4.0, 8.0]},
        boundaries=sides,
        time={"duration": 0.01},
        numerics={"continuum": {"size": 1.0}},
        record={"points": [[2.0, 6.0]]},
    )
    tables["joint_sets"][0] |= {"dip": 0.0, "through": [2.0, 4.0]}
    scene = jw.load(tables)
    jw.simulate(scene, "continuum-jointed").to_netcdf(tmp_path / "run.nc")
    (curves,) = read_curves([str(tmp_path / "run.nc")], [scene])
    results = {"oblique-joint": jw.simulate(scene, "oblique-joint")}
    rows = measure_curves(align_curve(curves, scene, results, False), results)
    forbidden = {"stress xy", "velocity x", "displacement x"}
    assert {row.quantity for row in rows if row.faint} == forbidden
    assert all(row.distance.misfit < 0.05 for row in rows if not row.faint)
