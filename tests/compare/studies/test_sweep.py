"""Sweeps as a user meets them: a folder for each point, one table, failures that stop nobody."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jointwave import cases
from jointwave.compare.scenes import find
from jointwave.compare.studies.sweep_table import summarise
from jointwave.dem import simulate

SCENE = "guo-li-2002/fig-03"
SHORT = ("--set", "time.duration=0.02", "--set", "record.velocity=[20.25]")
RATIO = "joints.damping_ratio"
KEYS = ("--sweep", f"{RATIO}=-1,0.02,0.1", "--sweep", "ends.end=free,quiet")
SWEPT = ("run", SCENE, "--variant", "", *SHORT, *KEYS)
ALONE = ("--workers", 1)
#: A comparison solves by everything that applies: it gets a short pillar.
PAIRS = ("--variant", "", "--no-spectral", *ALONE, "--set", "pillar.length=10.0")
PAIRS += ("--set", "time.duration=0.02", "--set", "record.stress=[4.0]")
PAIRS += ("--set", "record.velocity=[]")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("sweep")


@pytest.fixture
def swept(folder, command):
    """Return the folder of a sweep of two keys by two processes, two points of which fail, and
    what was said; made once."""
    if not (said := folder / "said").is_file():
        said.write_text(command(*SWEPT, "--workers", 2, "--out", folder / "out").out)
    return folder / "out", said.read_text()


def test_every_point_is_the_run_of_its_scene(swept):
    """The same numbers as of the scene with these keys set, in a folder that says them."""
    out, _ = swept
    for ratio in (0.02, 0.1):
        for end in ("free", "quiet"):
            changes = {RATIO: ratio, "ends.end": end, "time.duration": 0.02}
            scene = cases.load_variant(find(SCENE), "", changes | {"record.velocity": [20.25]})
            result = xr.load_dataset(out / f"{RATIO}={ratio},ends.end={end}" / "dem.nc")
            np.testing.assert_array_equal(result.stress, simulate(scene).stress)


def test_the_table_is_tidy(swept):
    """One row a receiver with its peak."""
    out, _ = swept
    rows = pd.read_csv(out / "sweep.csv")
    done = rows[rows.state == "done"]
    assert len(done) == 2 * 2 * 2 and set(done.quantity) == {"stress", "velocity"}
    result = xr.load_dataset(out / f"{RATIO}=0.1,ends.end=free" / "dem.nc")
    wave = result.stress.sel(stress_y=20.0)
    row = done[(done[RATIO] == 0.1) & (done["ends.end"] == "free") & (done.y == 20.0)].iloc[0]
    assert abs(row.peak) == pytest.approx(float(np.abs(wave).max()), rel=1e-8)
    assert float(wave.sel(time=row.time_of_peak, method="nearest")) == pytest.approx(row.peak)
    assert (row.engine, row.quantity, row.steps) == ("dem", "stress", result.attrs["steps"])


def test_a_point_that_fails_is_listed_and_stops_nobody(swept):
    out, said = swept
    rows = pd.read_csv(out / "sweep.csv")
    failed = rows[rows.state == "failed"]
    assert len(failed) == 2 and failed.message.str.contains("must be at least 0").all()
    assert said.count(f"failed: {RATIO}=-1") == 2
    assert (failed[RATIO] == -1).all() and failed.peak.isna().all()


def test_what_is_done_is_not_run_again(swept, command):
    """Nor is it when its result was removed: then it is made anew."""
    out, _ = swept
    file = out / f"{RATIO}=0.02,ends.end=free" / "dem.nc"
    other = out / f"{RATIO}=0.1,ends.end=free" / "dem.nc"
    before, kept = xr.load_dataset(file), other.stat().st_mtime_ns
    file.unlink()
    done = command(*SWEPT, *ALONE, "--json", "--out", out)
    assert len(json.loads(done.out)["rows"]) == 10
    assert xr.load_dataset(file).equals(before) and other.stat().st_mtime_ns == kept


def test_a_comparison_is_swept(command, tmp_path):
    """Misfits of every pair over the key, and the figure of each point."""
    done = command("compare", SCENE, "--sweep", "ends.start=free,quiet", *PAIRS, "--out", "out")
    assert "rigid blocks ~ rigid blocks, exact" in done.out and "stress at y = 4 m" in done.out
    rows = pd.read_csv(tmp_path / "out" / "sweep.csv")
    found = rows[(rows.pair == "dem ~ lattice") & (rows.quantity == "stress") & (rows.y == 4.0)]
    assert set(found["ends.start"]) == {"free", "quiet"}
    assert found.misfit.between(1e-9, 5e-3).all() and found.misfit.nunique() == 2
    assert (tmp_path / "out" / "ends.start=quiet" / "comparison.svg").is_file()


def test_the_worst_waveform_of_each_pair_is_shown():
    """Of three one is faint, and furthest off: it decides nothing. All are in the table."""
    numbers = dict.fromkeys(("peak_ratio", "delay", "period_ratio", "envelope", "phase"), 1.0)
    rows = [
        {"key": 3, "variant": "", "pair": "dem ~ lattice", "quantity": f"stress {k}"}
        | {"x": 1.0, "y": 2.0}
        | {"misfit": 0.01 * k, "faint": str(k == 3).lower(), "state": "done", "message": ""}
        | numbers
        for k in (1, 2, 3)
    ]
    found = summarise("scene", ["key"], None, pd.DataFrame(rows))
    assert found.table.index.tolist() == [
        ("rigid blocks ~ rigid blocks, exact", "3", "stress 2 at [1, 2] m")
    ]
    assert found.table.misfit.item() == 0.02 and "worst" in found.legend
    assert len(found.facts["rows"]) == 3


def test_curves_of_others_are_swept_too(command, tmp_path):
    """A file that has changed since is compared anew."""
    sweep = ("--sweep", "ends.start=free", "--with", "curve.csv", "--json", "--out", "out")
    found = []
    for peak in (0.1, 0.2, 0.2):
        text = f"time [ms], stress@4 [MPa]\n0, 0\n10, {peak}\n19, 0\n"
        (tmp_path / "curve.csv").write_text(text)
        rows = json.loads(command("compare", SCENE, *PAIRS, *sweep).out)["rows"]
        found.append([row["misfit"] for row in rows if row["one"] == "curve.csv"])
    assert found[0] and found[0] != found[1] == found[2]
    assert len(list((tmp_path / "out" / "points").iterdir())) == 2


def test_a_comparison_without_a_folder_writes_nothing(command, tmp_path):
    sweep = ("--sweep", "ends.start=free", "--json")
    facts = json.loads(command("compare", SCENE, *PAIRS, *sweep).out)
    assert facts["files"] == [] and facts["rows"] and not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "spec, words",
    [
        ("joints.dampng=0,1", "unknown key"),
        (f"{RATIO}=-1,-2", "must be at least 0"),
        (f"{RATIO}=1:2", "must be KEY=FROM"),
        ("time.duration=1,2", "is given already"),
    ],
)
def test_a_sweep_of_nothing_is_one_line(command, tmp_path, spec, words):
    """And nothing is written."""
    said = command("run", SCENE, *SHORT, "--sweep", spec, code=2).err
    assert said.count("\n") == 1 and words in said
    assert not list(tmp_path.iterdir())


def test_points_that_all_fail_as_they_run_are_one_line(command):
    """A step above the critical one is found out when the run is made."""
    spec = ("--sweep", "numerics.dem.step_fraction=1.5,2.0")
    said = command("run", SCENE, *SHORT, "--variant", "", *spec, *ALONE, code=2).err
    assert said.count("\n") == 1
    assert "all 2 points fail" in said and "critical step" in said


def test_a_value_that_makes_no_name_has_a_number(command, tmp_path):
    """A list, of which a folder's name would be unreadable."""
    spec = ("--sweep", "record.stress=[10.0],[20.0]")
    command("run", SCENE, "--variant", "", *SHORT, *spec, *ALONE, "--out", tmp_path)
    assert {"point-00001", "point-00002"} < {path.name for path in tmp_path.iterdir()}
    rows = pd.read_csv(tmp_path / "sweep.csv")
    assert rows["record.stress"].unique().tolist() == ["[10.0]", "[20.0]"]
