"""The one form of every result: its axes, units and scene, written to NetCDF without loss."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave.cases import load
from jointwave.cases.sampling import sample_times
from jointwave.results.dataset import AT_REST, TERMS, dataset, imbalance, scene_hash

CASES = Path(__file__).parents[2] / "cases"
POINTS = {"record.velocity": [19.75, 20.25]}
AXIAL = ("kinetic", "elastic", "viscous", "boundary", "work")  # terms of axial motion
ACROSS = POINTS | {"load.direction": [1.0, 0.0, 0.0]}
UNITS = {
    "Pa": {"stress", "shear", "traction", "stress_error", "shear_error"},
    "m/s": {"velocity", "velocity_error"},
    "m": {"displacement", "displacement_error", "gap", "slip", "stress_y", "velocity_y"}
    | {f"{kind}_{axis}" for kind in ("point", "joint_point") for axis in "xyz"},
    "rad": {"rotation", "rotation_error"},
    "J": {"energy"},
    "s": {"time"},
}
UNIT = {name: unit for unit, names in UNITS.items() for name in names}


def axial(scene, draw, times):
    """A result of motion along the axis: each waveform with the bound of its error."""
    n, errors = len(times), {"stress": np.array([2.0]), "velocity": np.array([3.0, 4.0])}
    sizes = {"stress": 1, "velocity": 2, "displacement": 2}
    waves = {name: draw(size=(points, n)) for name, points in sizes.items()}
    own = {"energy": draw(size=(len(AXIAL), n)), "terms": AXIAL, "errors": errors}
    return dataset(scene, "dem", times, waves, **own, known_until=0.01, dt=1e-6)


def across(scene, draw, times):
    """A result of motion across the axis, with the bounds of its errors."""
    n, sizes = len(times), {"stress": (1,), "shear": (1, 2), "velocity": (2, 3)}
    sizes |= {"displacement": (2, 3), "rotation": (2, 3)}
    values = {name: draw(size=(size[0], n, *size[1:])) for name, size in sizes.items()}
    errors = {name: np.ones(size) for name, size in sizes.items()}
    return dataset(scene, "dem", times, values, draw(size=(len(TERMS), n)), errors=errors, dt=1e-6)


def in_space(scene, draw, times):
    """A result of a rock mass in space."""
    points, joints, n = len(scene.record.points), len(scene.record.joints), len(times)
    shapes = {"velocity": (points, n, 3), "stress": (points, n, 6)}
    shapes |= {"traction": (joints, n, 3), "gap": (joints, n), "slip": (joints, n, 2)}
    values = {name: draw(size=shape) for name, shape in shapes.items()}
    energy = draw(size=(len(TERMS), n))
    return dataset(scene, "dem", times, values, energy, dt=1e-6)


@pytest.fixture(params=[axial, across, in_space])
def made(request, pillar):
    """A scene of each kind, and a result of random numbers with every variable."""
    if request.param is in_space:
        (scene,) = load(CASES / "rock-mass/cavern.toml")
    else:
        scene = pillar(**(POINTS if request.param is axial else ACROSS))
    return scene, request.param(scene, np.random.default_rng(1).normal, sample_times(scene))


def test_netcdf_round_trip(made, tmp_path):
    made[1].to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), made[1])


def test_every_variable_has_a_long_name_and_every_quantity_its_unit(made):
    """What xarray's plots write on their axes."""
    for name, variable in {**made[1].coords, **made[1].data_vars}.items():
        assert variable.attrs["long_name"], name
        assert variable.attrs.get("units") == UNIT.get(name), name
        assert (name in UNIT) == (variable.dtype.kind == "f"), name


def test_the_scene_stands_behind_what_is_shorter(made):
    """It is longer than a screen, and loads again (tests/test_jointwave.py)."""
    attributes = made[1].attrs
    assert list(attributes)[-1] == "scene" and attributes["dt"] == 1e-6
    assert "energy ledger" in json.loads(attributes["effects"])


def test_motion_and_stress_have_named_axes(made):
    scene, found = made
    axes = {name: values.values.tolist() for name, values in found.coords.items()}
    if "stress_component" in axes:
        assert axes["stress_component"] == ["xx", "yy", "zz", "xy", "yz", "xz"]
        assert axes["joint_axis"] == ["n", "strike", "dip"]
        assert axes["slip_axis"] == ["strike", "dip"]
        at = np.stack([axes[f"point_{axis}"] for axis in "xyz"], axis=1)
        assert at.tolist() == scene.record.points
    elif "across" in axes:
        assert found["shear"].dims == ("stress_y", "time", "across")
        assert found["rotation"].dims == ("velocity_y", "time", "axis")
        assert found["rotation_error"].dims == ("velocity_y", "axis")
        assert axes["across"] == ["x", "z"]
    is_axial = "stress_y" in axes and "across" not in axes
    assert axes["axis"] == (["y"] if is_axial else ["x", "y", "z"])
    assert axes["term"] == list(AXIAL if is_axial else TERMS)


def test_what_is_not_given_is_absent(pillar):
    scene = pillar()
    n = len(sample_times(scene))
    waves = {"stress": np.zeros((1, n)), "velocity": np.zeros((0, n))}
    bare = dataset(scene, "images", sample_times(scene), waves)
    assert set(bare.data_vars) == {"stress", "velocity"}


def test_hash_follows_every_number_and_the_samples_of_a_history(pillar, tmp_path):
    same = [scene_hash(pillar()), scene_hash(pillar())]
    other = scene_hash(pillar(**{"load.period": 0.010001}))
    assert len({*same, other}) == 2
    (tmp_path / "scene.toml").write_text((CASES / "beyond/blast-history.toml").read_text())
    hashes = set()
    for stress in (1.0, 2.0):
        (tmp_path / "blast-two-delays.csv").write_text(f"0,0\n0.01,{stress}\n")
        hashes.add(scene_hash(load(tmp_path / "scene.toml")[0]))
    assert len(hashes) == 2


RISE = np.linspace(0, 1, 5)
RESTS = {"kinetic": 2 * RISE, "elastic": 7 + RISE, "gravity": -3 + 0 * RISE, "work": 3 * RISE}
SLIDES = {"kinetic": RISE, "friction": 3 * RISE, "gravity": 5 - 4 * RISE, "work": 0 * RISE}
LEDGERS = {
    "a quarter of the work is missing": ({"kinetic": 3 * RISE, "work": 4 * RISE}, 0.25),
    "closed": ({"kinetic": 3 * RISE, "viscous": RISE, "work": 4 * RISE}, 0.0),
    "from a static state": (RESTS, 0.0),
    "from a static state, with a loss": (RESTS | {"kinetic": 1.7 * RISE}, 0.1),
    "a block slides down": (SLIDES, 0.0),
    "a block slides down, with a loss": (SLIDES | {"friction": 2 * RISE}, 0.25),
    "nothing moves": ({"kinetic": 0 * RISE, "work": 0 * RISE}, 0.0),
}


@pytest.mark.parametrize("name", LEDGERS)
def test_imbalance_is_over_the_largest_work_since_the_first_sample(name):
    """Without any work, over the largest term."""
    ledger, expected = LEDGERS[name]
    found = imbalance(np.stack(list(ledger.values())), tuple(ledger))
    assert found == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("at_rest", [1e6, 1e9, 1e14, 1e20])
def test_the_round_off_of_what_is_at_rest_is_no_loss(at_rest):
    """Of a row prestressed by up to ten thousand million times the load; a loss is seen as far as
    it can be told from that."""
    rng, rise = np.random.default_rng(7), np.linspace(0, 1, 50)
    parts = at_rest * rng.random(100) / 50
    elastic = np.array([np.sum(parts + x / 100 * rng.permutation(100) / 49.5) for x in rise])
    energy = np.stack([0 * rise, elastic, 0 * rise, 0 * rise, rise])
    assert imbalance(energy, AXIAL) < 1e-3
    energy[1] -= 0.1 * rise * max(1.0, AT_REST * elastic[0])
    assert imbalance(energy, AXIAL) == pytest.approx(0.1, rel=0.01)
