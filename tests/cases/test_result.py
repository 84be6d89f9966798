"""The one form of every result: written to NetCDF and read back without loss."""

import json

import numpy as np
import pytest
import xarray as xr

from cases import Scene, load
from cases.result import TERMS, dataset, energy_residual, scene_hash
from cases.sampling import sample_times

POINTS = {"record.velocity": [19.75, 20.25]}


@pytest.fixture
def result(scene_with):
    """A result of random numbers with every variable."""
    scene, draw = scene_with(**POINTS), np.random.default_rng(1).normal
    times = sample_times(scene)
    one, two, terms = (1, len(times)), (2, len(times)), (len(TERMS), len(times))
    return dataset(
        scene,
        "dem",
        times,
        draw(size=one),
        draw(size=two),
        draw(size=two),
        draw(size=terms),
        dt=1e-6,
    )


def test_netcdf_round_trip(result, tmp_path):
    result.to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), result)


def test_every_variable_has_a_unit(result):
    units = {name: result[name].attrs["units"] for name in result.data_vars}
    assert units == {"stress": "Pa", "velocity": "m/s", "displacement": "m", "energy": "J"}


def test_a_result_holds_its_scene(result, scene_with):
    held = Scene.model_validate_json(result.attrs["scene"])
    assert held.model_dump() == scene_with(**POINTS).model_dump()
    assert json.loads(result.attrs["effects"]) == ["energy ledger"]
    assert result.attrs["dt"] == 1e-6


def test_displacement_and_energy_are_absent_when_not_given(scene_with):
    scene = scene_with()
    n = len(sample_times(scene))
    bare = dataset(scene, "images", sample_times(scene), np.zeros((1, n)), np.zeros((0, n)))
    assert set(bare.data_vars) == {"stress", "velocity"}
    assert bare.velocity.dims == ("velocity_y", "time", "axis")


def test_hash_follows_every_number(scene_with):
    same = [scene_hash(scene_with()), scene_hash(scene_with())]
    other = scene_hash(scene_with(**{"load.period": 0.010001}))
    assert len({*same, other}) == 2


def test_hash_follows_the_samples_of_a_history(tmp_path, paper_folder):
    text = (paper_folder.parent / "beyond" / "blast-history.toml").read_text()
    (tmp_path / "scene.toml").write_text(text)
    hashes = set()
    for stress in (1.0, 2.0):
        (tmp_path / "blast-two-delays.csv").write_text(f"0,0\n0.01,{stress}\n")
        hashes.add(scene_hash(load(tmp_path / "scene.toml")[0]))
    assert len(hashes) == 2


def test_energy_residual_is_the_largest_imbalance_over_the_largest_work(result):
    energy = np.zeros(result.energy.shape)
    energy[TERMS.index("work")] = np.linspace(0, 4, energy.shape[1])
    energy[TERMS.index("kinetic")] = np.linspace(0, 3, energy.shape[1])
    assert energy_residual(result.assign(energy=(result.energy.dims, energy))) == pytest.approx(
        0.25
    )
    energy[TERMS.index("viscous")] = np.linspace(0, 1, energy.shape[1])
    balanced = result.assign(energy=(result.energy.dims, energy))
    assert energy_residual(balanced) == pytest.approx(0, abs=1e-15)
