"""Ensembles as a user meets them: members that resume, and their statistics."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.scenes import find
from jointwave.compare.studies.sweep_keys import cases_of
from jointwave.compare.studies.sweep_table import PERCENTILES, STATISTICS
from jointwave.dem import simulate

SCENE = "beyond/random-joints"
SHORT = {"time.duration": 0.02, "record.stress": [10.0, 20.0]}
KEYS = [part for k, v in SHORT.items() for part in ("--set", f"{k}={v}")]
MEMBERS = 5


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("ensemble")


@pytest.fixture
def ensemble(folder, command):
    """Return the folder of an ensemble of runs by two processes, made once."""
    if not list(folder.iterdir()):
        asked = ["run", SCENE, "--variant", "", *KEYS, "--ensemble", MEMBERS, "--workers", 2]
        command(*asked, "--out", folder)
    return folder


def waves() -> np.ndarray:
    """Return the stress of every member, each simulated by itself."""
    seeds = range(1, MEMBERS + 1)
    scenes = (cases.load_variant(find(SCENE), "", SHORT | {"scatter.seed": seed}) for seed in seeds)
    return np.stack([simulate(scene).stress.values for scene in scenes])


def test_members_are_scenes_of_the_following_seeds(ensemble):
    stress = waves()
    for k in range(MEMBERS):
        result = xr.load_dataset(ensemble / f"member={k + 1}" / "dem.nc")
        np.testing.assert_array_equal(result.stress, stress[k])


def test_statistics_are_those_of_the_members(ensemble):
    """Of waveforms at every sample, and of the peaks in the table."""
    stress, found = waves(), xr.load_dataset(ensemble / "dem-ensemble.nc")
    assert found.statistic.values.tolist() == list(STATISTICS)
    np.testing.assert_allclose(found.stress.sel(statistic="mean"), stress.mean(axis=0), rtol=1e-12)
    percentiles = np.percentile(stress, PERCENTILES, axis=0)
    np.testing.assert_allclose(found.stress[1:], percentiles, rtol=1e-12)
    assert (found.attrs["members"], found.attrs["engine"]) == (MEMBERS, "dem")
    rows = pd.read_csv(ensemble / "ensemble.csv").set_index(["number", "quantity", "y"])
    peaks = [wave[np.abs(wave).argmax()] for wave in stress[:, 1]]
    row = rows.loc[("peak", "stress", 20.0)]
    expected = [np.mean(peaks), *np.percentile(peaks, PERCENTILES), MEMBERS]
    assert row[[*STATISTICS, "members"]].tolist() == pytest.approx(expected, rel=1e-8)


def test_an_ensemble_resumes(ensemble, command):
    """Members that are done stay as they are; one whose result is gone, and more, are run."""
    done = {path: path.stat().st_mtime_ns for path in ensemble.glob("member=*/dem.nc")}
    gone = ensemble / "member=2" / "dem.nc"
    gone.unlink()
    asked = ["run", SCENE, "--variant", "", *KEYS, "--ensemble", MEMBERS + 1, "--json"]
    said = command(*asked, "--workers", 1, "--out", ensemble).out
    again = {path for path, at in done.items() if path.stat().st_mtime_ns != at}
    assert again == {gone} and (ensemble / f"member={MEMBERS + 1}" / "dem.nc").is_file()
    facts = json.loads(said)
    assert {row["members"] for row in facts["statistics"]} == {MEMBERS + 1}


def test_misfits_and_waveforms_of_a_comparison(command, tmp_path):
    short = ["--set", "pillar.length=10.0", "--set", "record.stress=[5.0]", *KEYS[:2]]
    asked = ["compare", SCENE, "--variant", "", *short, "--no-spectral", "--ensemble", "3"]
    said = command(*asked, "--workers", 1, "--out", tmp_path).out
    assert "rigid blocks ~ rigid blocks, exact" in said
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


def test_a_rock_mass_shifts_the_seed_of_every_set():
    found = cases_of("rock-mass/random-network", [], "", [], None, 2)
    seeds = [[one.seed for one in case.scene.joint_sets] for case in found]
    assert seeds == [[27, 671], [28, 672]]


def test_a_scene_without_joints_at_random_has_no_members():
    with pytest.raises(SceneError, match=r"--ensemble: needs random joints: \[scatter\]"):
        cases_of("guo-li-2002/fig-03", [], "", [], Path("out"), 3)
