"""The one form of every result: written to NetCDF and read back without loss."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave.cases import Scene, load
from jointwave.cases.sampling import sample_times
from jointwave.results.arrays import size_of
from jointwave.results.dataset import (
    ALL_TERMS,
    AT_REST,
    DIMENSIONS,
    TERMS,
    dataset,
    energy_residual,
    imbalance,
    scene_hash,
)
from jointwave.results.labels import LABELS
from jointwave.results.rock_mass import TERMS as ROCK_TERMS
from jointwave.results.rock_mass import rock_mass_dataset

CAVERN = Path(__file__).parents[2] / "cases/rock-mass/cavern.toml"
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


def test_every_variable_and_coordinate_has_a_long_name(result):
    """And a unit, if it is a quantity: what xarray's plots write on their axes."""
    for name, variable in {**result.coords, **result.data_vars}.items():
        long_name, unit = LABELS[name]
        assert variable.attrs == {"long_name": long_name} | ({"units": unit} if unit else {})
        assert bool(unit) == (variable.dtype.kind == "f")


def test_the_longest_attribute_comes_last(result):
    assert max(result.attrs, key=lambda name: len(str(result.attrs[name]))) == "scene"
    assert list(result.attrs)[-1] == "scene"


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


def test_a_computed_result_holds_its_error_by_waveform(pillar, tmp_path):
    """Of axial motion with its one axis."""
    scene = pillar(record__energy=False, record__stress=[5.0], record__velocity=[1, 2])
    n = len(sample_times(scene))
    errors = {"stress": np.array([2.0]), "velocity": np.array([3.0, 4.0])}
    waves = np.zeros((1, n)), np.zeros((2, n))
    found = dataset(scene, "lattice", sample_times(scene), *waves, errors=errors, known_until=0.01)
    assert found["stress_error"].values.tolist() == [2.0]
    assert found["velocity_error"].dims == ("velocity_y", "axis")
    assert found["velocity_error"].values[:, 0].tolist() == [3.0, 4.0]
    assert found["velocity_error"].attrs["units"] == "m/s" and found.attrs["known_until"] == 0.01
    assert "displacement_error" not in found
    found.to_netcdf(tmp_path / "own.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "own.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), found)


def test_the_bounds_of_a_spatial_result_have_its_axes(scene_with):
    scene = scene_with(**POINTS, **{"load.direction": [1.0, 0.0, 0.0]})
    n = len(sample_times(scene))
    waves = np.zeros((1, n)), np.zeros((2, n, 3))
    sizes = {"stress": 1, "shear": (1, 2), "velocity": (2, 3), "displacement": (2, 3)}
    errors = {name: np.ones(size) for name, size in (sizes | {"rotation": (2, 3)}).items()}
    found = dataset(scene, "own", sample_times(scene), *waves, waves[1], errors=errors)
    for name in errors:
        assert found[f"{name}_error"].dims == tuple(d for d in DIMENSIONS[name])
        assert found[f"{name}_error"].shape == errors[name].shape


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


@pytest.fixture
def spatial(scene_with):
    """A result of random numbers of a scene that moves across its axis."""
    scene = scene_with(**POINTS, **{"load.direction": [1.0, 0.0, 0.0]})
    draw, times = np.random.default_rng(2).normal, sample_times(scene)
    n = len(times)
    return dataset(
        scene,
        "dem",
        times,
        draw(size=(1, n)),
        draw(size=(2, n, 3)),
        draw(size=(2, n, 3)),
        draw(size=(len(ALL_TERMS), n)),
        shear=draw(size=(1, n, 2)),
        rotation=draw(size=(2, n, 3)),
        terms=ALL_TERMS,
    )


def test_a_spatial_result_has_three_axes(spatial):
    assert spatial.axis.values.tolist() == ["x", "y", "z"]
    assert spatial.velocity.dims == spatial.rotation.dims == ("velocity_y", "time", "axis")
    assert spatial["shear"].dims == ("stress_y", "time", "across")
    assert spatial.across.values.tolist() == ["x", "z"]
    assert spatial["shear"].attrs["units"] == "Pa" and spatial.rotation.attrs["units"] == "rad"
    assert spatial.term.values.tolist() == list(ALL_TERMS)


def test_a_spatial_result_is_written_and_read(spatial, tmp_path):
    spatial.to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), spatial)


def test_axial_terms_are_among_all_terms_in_their_order():
    assert [term for term in ALL_TERMS if term in TERMS] == list(TERMS)


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


def test_the_ledger_counts_from_the_first_sample():
    """The energy of a static state was there before any work, whichever terms hold it."""
    terms = ("kinetic", "elastic", "gravity", "work")
    rise = np.linspace(0, 1, 5)
    energy = np.stack([2 * rise, 7 + rise, -3 * np.ones(5), 3 * rise])
    assert imbalance(energy, terms) == pytest.approx(0, abs=1e-15)
    energy[0] -= 0.3 * rise
    assert imbalance(energy, terms) == pytest.approx(0.1)


@pytest.mark.parametrize("at_rest", [1e6, 1e9, 1e14, 1e20])
def test_the_round_off_of_what_is_at_rest_is_no_loss(at_rest):
    """Of a row prestressed by up to ten thousand million times the load; a loss is seen as far as
    it can be told from that."""
    rng, rise = np.random.default_rng(7), np.linspace(0, 1, 50)
    parts = at_rest * rng.random(100) / 50
    elastic = np.array([np.sum(parts + x / 100 * rng.permutation(100) / 49.5) for x in rise])
    energy = np.stack([0 * rise, elastic, 0 * rise, 0 * rise, rise])
    assert imbalance(energy) < 1e-3
    energy[1] -= 0.1 * rise * max(1.0, AT_REST * elastic[0])
    assert imbalance(energy) == pytest.approx(0.1, rel=0.01)


def test_where_no_work_is_done_the_largest_term_is_the_scale():
    """A block that slides down: its weight pays for motion and friction."""
    terms = ("kinetic", "friction", "gravity", "work")
    fall = np.linspace(0, 1, 5)
    energy = np.stack([fall, 3 * fall, 5.0 - 4 * fall, 0 * fall])
    assert imbalance(energy, terms) == pytest.approx(0, abs=1e-15)
    energy[1] -= fall
    assert imbalance(energy, terms) == pytest.approx(0.25)
    assert imbalance(0 * energy, terms) == 0.0


def test_size_is_that_of_all_arrays_in_nested_tuples():
    """Absent parts and plain numbers hold nothing."""
    parts = (np.zeros(3), None, 2.0, (np.zeros((2, 2), dtype=np.int32), (None, np.zeros(1))))
    assert size_of(parts, np.zeros(5)) == 24 + 16 + 8 + 40


def test_a_rock_mass_in_space_has_three_axes_and_six_stresses(tmp_path):
    (scene,) = load(CAVERN)
    points, joints, times = len(scene.record.points), len(scene.record.joints), sample_times(scene)
    draw, n = np.random.default_rng(2).normal, len(times)
    shapes = {"velocity": (points, n, 3), "stress": (points, n, 6)}
    shapes |= {"traction": (joints, n, 3), "gap": (joints, n), "slip": (joints, n, 2)}
    values = {name: draw(size=shape) for name, shape in shapes.items()}
    found = rock_mass_dataset(scene, "dem", times, values, draw(size=(len(ROCK_TERMS), n)))
    assert found.axis.values.tolist() == ["x", "y", "z"]
    assert found.stress_component.values.tolist() == ["xx", "yy", "zz", "xy", "yz", "xz"]
    assert found.joint_axis.values.tolist() == ["n", "strike", "dip"]
    assert found.slip_axis.values.tolist() == ["strike", "dip"]
    at = np.stack([found[f"point_{axis}"].values for axis in "xyz"], axis=1)
    assert at.tolist() == scene.record.points and found.energy.attrs["units"] == "J"
    found.to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), found)
