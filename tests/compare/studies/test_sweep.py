"""Sweeps and ensembles: a folder a point, one table, statistics, failures that stop nobody."""

import json
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.scenes import find
from jointwave.compare.studies.sweep_keys import axes, cases_of
from jointwave.compare.studies.sweep_table import PERCENTILES, STATISTICS
from jointwave.dem import simulate

SCENE, RANDOM = "guo-li-2002/fig-03", "beyond/random-joints"
RATIO = "joints.damping_ratio"
SHORT = {"time.duration": 0.02, "record.velocity": [20.25]}
BRIEF = {"time.duration": 0.02, "record.stress": [10.0, 20.0]}
ALONE, MEMBERS = ("--workers", 1), 5


def keys(changes):
    return [part for k, v in changes.items() for part in ("--set", f"{k}={v}")]


def run(*more):
    return ("run", SCENE, "--variant", "", *keys(SHORT), *more)


def compare(*more, stress=4.0, scene=SCENE):
    """Return a comparison of all that applies to ten metres."""
    short = {"pillar.length": 10.0, "time.duration": 0.02, "record.stress": [stress]}
    options = ("--variant", "", "--no-spectral", *ALONE, *keys(short | {"record.velocity": []}))
    return ("compare", scene, *options, *more)


ENSEMBLE = ("run", RANDOM, "--variant", "", *keys(BRIEF), "--ensemble")


@pytest.fixture
def ensemble(once, command):
    def made(out):
        command(*ENSEMBLE, MEMBERS, *ALONE, "--out", out)
        return out

    return once("ensemble of a sweep", made)


def test_every_point_is_the_run_of_its_scene(command, tmp_path):
    """In a sweep of two keys by two processes, two points of which fail."""
    sweep = ("--sweep", f"{RATIO}=-1,0.02,0.1", "--sweep", "ends.end=free,quiet")
    said = command(*run(*sweep, "--workers", 2, "--out", tmp_path)).out
    rows = pd.read_csv(tmp_path / "sweep.csv")
    done, failed = (rows[rows.state == state] for state in ("done", "failed"))
    assert len(done) == 2 * 2 * 2 and set(done.quantity) == {"stress", "velocity"}
    for ratio, end in product((0.02, 0.1), ("free", "quiet")):
        changes = SHORT | {RATIO: ratio, "ends.end": end}
        expected = simulate(cases.load_variant(find(SCENE), "", changes))
        result = xr.load_dataset(tmp_path / f"{RATIO}={ratio},ends.end={end}" / "dem.nc")
        np.testing.assert_array_equal(result.stress, expected.stress)
        wave = expected.stress.sel(stress_y=20.0)
        row = done[(done[RATIO] == ratio) & (done["ends.end"] == end) & (done.y == 20.0)].squeeze()
        assert abs(row.peak) == pytest.approx(float(np.abs(wave).max()), rel=1e-8)
        at = wave.sel(time=row.time_of_peak, method="nearest")
        assert float(at) == pytest.approx(row.peak)
        assert (row.engine, row.steps) == ("dem", expected.attrs["steps"])
    assert len(failed) == 2 and failed.message.str.contains("must be at least 0").all()
    assert said.count(f"failed: {RATIO}=-1") == 2
    assert (failed[RATIO] == -1).all() and failed.peak.isna().all()


def test_a_comparison_is_swept_beside_curves_of_others(command, tmp_path):
    """Misfits of every pair over the key, and the figure of each point; a file of others that has
    changed since is compared anew."""
    sweep = ("--sweep", "ends.start=free,quiet", "--with", "curve.csv", "--out", "out")
    found = []
    for peak in (0.1, 0.2, 0.2):
        text = f"time [ms], stress@4 [MPa]\n0, 0\n10, {peak}\n19, 0\n"
        (tmp_path / "curve.csv").write_text(text)
        told = json.loads(command(*compare(*sweep, "--json")).out)["rows"]
        found.append([row["misfit"] for row in told if row["one"] == "curve.csv"])
    assert found[0] and found[0] != found[1] == found[2]
    assert len(list((tmp_path / "out" / "points").iterdir())) == 2 * 2
    said = command(*compare(*sweep)).out
    assert "rigid blocks ~ rigid blocks, exact" in said and "stress at y = 4 m" in said
    rows = pd.read_csv(tmp_path / "out" / "sweep.csv")
    for number in ("misfit", "delay", "floor"):  # to the digits of the file, however small
        expected = pytest.approx(rows[number].to_numpy(), rel=1e-8, nan_ok=True)
        assert pd.DataFrame(told)[number].astype(float).to_numpy() == expected
    blocks = rows[(rows.pair == "dem ~ lattice") & (rows.quantity == "stress") & (rows.y == 4.0)]
    assert set(blocks["ends.start"]) == {"free", "quiet"}
    assert blocks.misfit.between(1e-9, 5e-3).all() and blocks.misfit.nunique() == 2
    assert (tmp_path / "out" / "ends.start=quiet" / "comparison.svg").is_file()


@pytest.mark.parametrize(
    "spec, words",
    [
        ("joints.dampng=0,1", "unknown key"),
        (f"{RATIO}=-1,-2", "must be at least 0"),
        ("numerics.dem.step_fraction=1.5,2.0", "all 2 points fail"),
    ],
)
def test_a_sweep_of_nothing_is_one_line(command, tmp_path, spec, words):
    said = command(*run("--sweep", spec), *ALONE, code=2).err
    assert said.count("\n") == 1 and words in said
    assert not list(tmp_path.iterdir())


def test_a_value_that_makes_no_name_has_a_number(command, tmp_path):
    command(*run("--sweep", "record.stress=[10.0],[20.0]"), *ALONE, "--out", tmp_path)
    assert {"point-00001", "point-00002"} < {path.name for path in tmp_path.iterdir()}
    rows = pd.read_csv(tmp_path / "sweep.csv")
    assert rows["record.stress"].unique().tolist() == ["[10.0]", "[20.0]"]


def test_members_have_the_following_seeds_and_statistics_are_theirs(ensemble):
    seeds = [BRIEF | {"scatter.seed": 1 + k} for k in range(MEMBERS)]
    runs = [simulate(cases.load_variant(find(RANDOM), "", changes)) for changes in seeds]
    stress = np.stack([one.stress.values for one in runs])
    for k, expected in enumerate(stress):
        result = xr.load_dataset(ensemble / f"member={k + 1}" / "dem.nc")
        np.testing.assert_array_equal(result.stress, expected)
    found = xr.load_dataset(ensemble / "dem-ensemble.nc")
    assert found.statistic.values.tolist() == list(STATISTICS)
    np.testing.assert_allclose(found.stress.sel(statistic="mean"), stress.mean(axis=0), rtol=1e-12)
    percentiles = np.percentile(stress, PERCENTILES, axis=0)
    np.testing.assert_allclose(found.stress[1:], percentiles, rtol=1e-12)
    assert (found.attrs["members"], found.attrs["engine"]) == (MEMBERS, "dem")
    rows = pd.read_csv(ensemble / "ensemble.csv").set_index(["number", "quantity", "y"])
    peaks = np.abs(stress[:, 1]).max(axis=1)
    row = rows.loc[("peak", "stress", 20.0)]
    expected = [np.mean(peaks), *np.percentile(peaks, PERCENTILES), MEMBERS]
    assert row[[*STATISTICS, "members"]].tolist() == pytest.approx(expected, rel=1e-8)


def test_an_ensemble_resumes(ensemble, command):
    done = {path: path.stat().st_mtime_ns for path in ensemble.glob("member=*/dem.nc")}
    gone = ensemble / "member=2" / "dem.nc"
    gone.unlink()
    said = command(*ENSEMBLE, MEMBERS + 1, "--json", *ALONE, "--out", ensemble).out
    again = {path for path, at in done.items() if path.stat().st_mtime_ns != at}
    assert again == {gone} and (ensemble / f"member={MEMBERS + 1}" / "dem.nc").is_file()
    facts = json.loads(said)
    assert {row["members"] for row in facts["statistics"]} == {MEMBERS + 1}


def test_an_ensemble_has_the_misfits_and_waveforms_of_a_comparison(command, tmp_path):
    command(*compare("--ensemble", "3", "--out", tmp_path, stress=5.0, scene=RANDOM))
    table = pd.read_csv(tmp_path / "sweep.csv")
    rows = pd.read_csv(tmp_path / "ensemble.csv")
    pair = {"one": "dem", "other": "lattice", "quantity": "stress"}
    of_pair = table[(table[list(pair)] == list(pair.values())).all(axis=1)]
    row = rows[(rows[list(pair)] == list(pair.values())).all(axis=1) & (rows.number == "misfit")]
    assert sorted(of_pair.member) == [1, 2, 3]
    assert float(row["mean"].iloc[0]) == pytest.approx(of_pair.misfit.mean(), rel=1e-7)
    exact = xr.load_dataset(tmp_path / "exact-jointed-bar-ensemble.nc").stress.sel(statistic="p50")
    files = [tmp_path / f"member={k}" / "exact-jointed-bar.nc" for k in (1, 2, 3)]
    every = [xr.load_dataset(file).stress for file in files]
    np.testing.assert_allclose(exact, np.median(every, axis=0), rtol=1e-12, atol=1e-9)
    assert "jointed bar, exact" in (tmp_path / "ensemble-waveforms.svg").read_text()
    assert (tmp_path / "ensemble-waveforms.png").read_bytes().startswith(b"\x89PNG")


def test_an_ensemble_counts_each_solution_once_and_leaves_those_of_others(command, tmp_path):
    """Where an engine is named twice, members count once. The size of a peak has statistics: its
    sign differs from member to member under two cycles of a sine. Results that an earlier command
    has left in the folder are of another scene."""
    changes = {"pillar.length": 30.0, "time.duration": 0.05, "record.stress": [20.0]}
    load = {"load.shape": "sine", "load.period": 0.008, "load.cycles": 2}
    scatter = {"scatter.spacing": 0.5, "scatter.compliance": 0.5}
    models = [["--engine", "exact", "--model", name] for name in ("lattice", "jointed-bar")]
    asked = ["run", RANDOM, "--variant", "", *keys(changes | load | scatter), "--out", tmp_path]
    command(*asked, *models[0], *models[1], "--ensemble", 4, *ALONE)
    rows, bar = pd.read_csv(tmp_path / "sweep.csv"), tmp_path / "exact-jointed-bar-ensemble.nc"
    peaks = rows[rows.engine == "lattice"].peak.tolist()
    assert len(peaks) == 4 and min(peaks) < 0 < max(peaks)
    found = pd.read_csv(tmp_path / "ensemble.csv")
    row = found[(found.engine == "lattice") & (found.number == "peak")].iloc[0]
    expected = [np.mean(np.abs(peaks)), *np.percentile(np.abs(peaks), PERCENTILES), 4]
    assert row[[*STATISTICS, "members"]].tolist() == pytest.approx(expected, rel=1e-8)
    before = bar.read_bytes()
    bar.write_bytes(before[:-1])
    command(*asked, *models[0], "--ensemble", 4, *ALONE, "--set", "load.amplitude=3e6")
    assert bar.read_bytes() == before[:-1]
    assert "jointed bar" not in (tmp_path / "ensemble-waveforms.svg").read_text()


def test_the_peak_of_a_stress_in_rock_is_the_principal_one(command, tmp_path, one_joint, in_toml):
    """Of a P wave that a joint as good as welded lets pass, at whatever angle."""
    joint = {"name": "weld", "dip": 0.0, "through": [10.0, 15.0]}
    joint |= dict.fromkeys(("normal_stiffness", "shear_stiffness"), 1e15)
    (tmp_path / "scene.toml").write_text(in_toml(one_joint(joint_sets=[joint])))
    swept = ("--sweep", "waves.0.direction=[0.6,0.8],[-0.28,0.96]", "--engine", "exact")
    facts = command("run", "scene.toml", *swept, *ALONE, "--json").out
    peaks = [row["peak"] for row in json.loads(facts)["rows"] if row["quantity"] == "stress"]
    assert peaks == pytest.approx(len(peaks) * [1e6], rel=1e-3) and len(peaks) == 4


def test_an_ensemble_shifts_every_seed_there_is():
    """Those of a variant are its own; of two sets, beyond those of the other. Without an ensemble
    `member` is a key as any other."""
    found = cases_of("rock-mass/random-network", [], "", [], None, 2)
    seeds = [[one.seed for one in case.scene.joint_sets] for case in found]
    assert seeds == [[27, 671], [672, 1316]]
    found = cases_of(RANDOM, [], None, [], None, 2)
    assert [case.scene.scatter.seed for case in found] == [1, 2, 2, 3]
    with pytest.raises(SceneError, match="member = 'a': unknown key"):
        cases_of(SCENE, [], "", ["member=a,b"], None)
    with pytest.raises(SceneError, match=r"--ensemble: needs random joints: \[scatter\]"):
        cases_of(SCENE, [], "", [], Path("out"), 3)


@pytest.mark.parametrize(
    "spec, expected",
    [
        ("0:1:5", [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("0.1:0.7:7", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),  # no round-off in names of folders
        ("2:-2:3", [2, 0, -2]),
        ("1:4:4", [1, 2, 3, 4]),  # whole numbers, for keys that take no others
        ("1:4:3", [1.0, 2.5, 4.0]),
        ("log:1e8:1e10:3", [1e8, 1e9, 1e10]),
        ("0,0.1,0.5", [0, 0.1, 0.5]),
        ("true,false", [True, False]),
        ("free,quiet", ["free", "quiet"]),
        ('"a,b","c:d"', ["a,b", "c:d"]),
        ("[0,1,0],[1,0,0]", [[0, 1, 0], [1, 0, 0]]),
        ("[],[{y=8.0,thickness=0.1}]", [[], [{"y": 8.0, "thickness": 0.1}]]),
    ],
)
def test_values_are_what_is_written(spec, expected):
    found = axes([f"{RATIO}={spec}"], [])
    assert found == {RATIO: expected}
    assert list(map(type, found[RATIO])) == list(map(type, expected))


@pytest.mark.parametrize(
    "given, words",
    [
        *((f"a={spec}", "must be KEY=FROM:TO:COUNT") for spec in ("", "1:2", "1:2:3:4")),
        ("nothing", "must be KEY=FROM:TO:COUNT"),
        *((f"a={spec}", "of numbers") for spec in ("log:1:2", "a:b:3", "1:2:2.5")),
        *((f"a={spec}", "COUNT of 2") for spec in ("1:2:1", "1:2:-3", "1:2:20000")),
        ("a=1:1:3", "ends that differ"),
        *((f"a={spec}", "finite ends") for spec in ("nan:1:3", "1:inf:3")),
        *((f"a={spec}", "one sign") for spec in ("log:0:1:3", "log:-1:1:3")),
        *((f"a={spec}", "repeat a value") for spec in ("0.1,0.1", "1,true,1.0")),
        ("a=1,2 a=3,4", "a is given already"),
        ("set=1,2", "set is given already"),
        ("a=1:2:100 b=1:2:200", "20,000 points; at most 10,000"),
    ],
)
def test_a_bad_form_is_one_line(given, words):
    with pytest.raises(SceneError, match=words) as error:
        axes(given.split(" "), ["set"])
    assert str(error.value).startswith("--sweep: ") and "\n" not in str(error.value)
