"""Snapshots travel in a result, and what a scene may ask for is said in one line."""

import numpy as np
import pytest
import xarray as xr

from jointwave.cases import SceneError
from jointwave.cases.sampling import sample_times
from jointwave.results.snapshots import (
    SnapshotRecorder,
    Snapshots,
    in_space,
    refuse_beyond_room,
    samples_between,
    snapshots,
    snapshots_of,
    with_snapshots,
)


@pytest.fixture
def found():
    """Two lines, one behind the other with a node each at the joint, at two instants."""
    draw = np.random.default_rng(3).normal
    return snapshots(
        np.array([0.0, 1e-3]),
        np.array([[0.0], [0.5], [0.5], [1.0]]),
        "line",
        np.array([[0, 1], [2, 3]]),
        np.array([0, 1]),
        draw(size=(2, 4, 1)),
        draw(size=(2, 4, 3)),
        draw(size=(2, 2)),
    )


def assert_equal(one: Snapshots, other: Snapshots):
    for name, values in one._asdict().items():
        np.testing.assert_array_equal(values, getattr(other, name), name)


@pytest.mark.parametrize("stress", [True, False])
def test_snapshots_come_back_from_a_result_and_from_its_file(found, stress, tmp_path):
    if not stress:
        found = found._replace(stress=None)
    run = xr.Dataset(coords={"time": np.arange(3.0)}, attrs={"engine": "dem"})
    held = with_snapshots(run, found)
    assert_equal(snapshots_of(held), found)
    held.to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        assert_equal(snapshots_of(back), found)
        assert back.field_displacement.dims == ("field_time", "node", "component")
        assert back.field_displacement.attrs["units"] == "m"
        assert back.field_velocity.attrs["units"] == "m/s"
        assert back.component.values.tolist() == ["x", "y", "z"]


def test_a_result_without_snapshots_has_none():
    assert snapshots_of(xr.Dataset()) is None


@pytest.mark.parametrize(
    ("given", "placed"),
    [([2.0], [0, 2, 0]), ([1.0, 2.0], [1, 2, 0]), ([1.0, 2.0, 3.0], [1, 2, 3])],
)
def test_vectors_of_fewer_dimensions_lie_along_y_and_then_x(given, placed):
    assert in_space(np.array([given])).tolist() == [placed]


def test_later_snapshots_are_the_rest(found):
    later = found.since(1)
    assert later.time.tolist() == [1e-3] and later.stress.shape == (1, 2)
    np.testing.assert_array_equal(later.displacement[0], found.displacement[1])
    assert found._replace(stress=None).since(1).stress is None


def test_a_recorder_keeps_every_so_many_samples(scene_with):
    recorder = SnapshotRecorder(
        scene_with(**{"record.fields": 1.5e-4}), 8, lambda sample: 10 * sample
    )
    for sample in range(8):
        recorder.record_if_due(sample)
    assert recorder.frames == [0, 30, 60]


@pytest.mark.parametrize(
    ("fields", "every"), [(None, None), (5e-5, 1), (1e-4, 2), (1.2e-4, 2), (1.3e-4, 3)]
)
def test_time_between_snapshots_is_a_whole_number_of_samples(scene_with, fields, every):
    changes = {} if fields is None else {"record.fields": fields}
    assert samples_between(scene_with(**changes)) == every


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (4.9e-5, "between the sampling interval 5e-05 s and time.duration"),
        (0.2, "time.duration = 0.12"),
        (0.0, "greater than 0"),
        ("often", "a number"),
    ],
)
def test_a_time_that_does_not_fit_is_refused(scene_with, fields, words):
    with pytest.raises(SceneError, match=r"record\.fields = ") as caught:
        scene_with(**{"record.fields": fields})
    assert words in str(caught.value)


def test_too_many_snapshots_are_refused(scene_with):
    with pytest.raises(SceneError, match="at most 10,000 snapshots"):
        scene_with(**{"record.fields": 5e-5, "time.duration": 0.6})


def test_snapshots_that_fit_no_file_are_refused(scene_with):
    """A variable of NetCDF 3 has less than 2 GiB: 89,478 vectors in each of 1000 snapshots."""
    scene = scene_with(**{"record.fields": 1e-4, "time.duration": 0.0999})
    refuse_beyond_room(scene, 89_478)
    with pytest.raises(SceneError, match="1,000 snapshots of 89,479 nodes; at most 999 fit"):
        refuse_beyond_room(scene, 89_479)


def test_the_scene_itself_says_when_it_is_sampled(scene_with):
    """The last snapshot is no later than the last sample."""
    scene = scene_with(**{"record.fields": 7e-3})
    every = samples_between(scene)
    assert every == 140 and sample_times(scene)[::every][-1] == pytest.approx(0.119)
