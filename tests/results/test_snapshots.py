"""Snapshots travel in a result, and what a scene may ask for is said in one line."""

import numpy as np
import pytest
import xarray as xr

from jointwave.cases import SceneError
from jointwave.cases.sampling import sample_times
from jointwave.results.snapshots import (
    refuse_beyond_room,
    samples_between,
    snapshots,
    snapshots_of,
    with_snapshots,
)


@pytest.mark.parametrize("stress", [True, False])
def test_snapshots_come_back_from_a_result_and_from_its_file(stress, tmp_path):
    """Two lines along y with a node each at the joint between them, at two instants."""
    draw, cells = np.random.default_rng(3).normal, np.array([[0, 1], [2, 3]])
    points, motion = np.array([[0.0], [0.5], [0.5], [1.0]]), (draw(size=(2, 4, k)) for k in (1, 3))
    own = draw(size=(2, 2)) if stress else None
    times = np.array([0.0, 1e-3])
    found = snapshots(times, points, "line", cells, np.array([0, 1]), *motion, own)
    assert found.points.tolist() == [[0, 0, 0], [0, 0.5, 0], [0, 0.5, 0], [0, 1, 0]]
    run = xr.Dataset(coords={"time": np.arange(3.0)}, attrs={"engine": "dem"})
    assert snapshots_of(run) is None
    held = with_snapshots(run, found)
    held.to_netcdf(tmp_path / "dem.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "dem.nc", engine="scipy") as back:
        for one in (held, back):
            for name, values in found._asdict().items():
                np.testing.assert_array_equal(values, getattr(snapshots_of(one), name), name)
        assert back.field_displacement.dims == ("field_time", "node", "component")
        assert back.field_displacement.attrs["units"] == "m"
        assert back.field_velocity.attrs["units"] == "m/s"
        assert back.component.values.tolist() == ["x", "y", "z"]


@pytest.mark.parametrize(
    ("fields", "every"), [(None, None), (5e-5, 1), (1e-4, 2), (1.2e-4, 2), (1.3e-4, 3), (7e-3, 140)]
)
def test_time_between_snapshots_is_a_whole_number_of_samples(pillar, fields, every):
    """The last of 120 ms is no later than the last sample."""
    scene = pillar(**({} if fields is None else {"record.fields": fields}))
    assert samples_between(scene) == every
    if every == 140:
        assert sample_times(scene)[::every][-1] == pytest.approx(0.119)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"record.fields": 4.9e-5}, "between the sampling interval 5e-05 s and time.duration"),
        ({"record.fields": 0.2}, "time.duration = 0.12"),
        ({"record.fields": 5e-5, "time.duration": 0.6}, "at most 10,000 snapshots"),
    ],
)
def test_a_time_that_does_not_fit_is_refused(pillar, changes, words):
    with pytest.raises(SceneError, match=r"record\.fields = ") as caught:
        pillar(**changes)
    assert words in str(caught.value)


def test_snapshots_that_fit_no_file_are_refused(pillar):
    """A variable of NetCDF 3 has less than 2 GiB: 89,478 vectors in each of 1000 snapshots."""
    scene = pillar(**{"record.fields": 1e-4, "time.duration": 0.0999})
    refuse_beyond_room(scene, 89_478)
    with pytest.raises(SceneError, match="1,000 snapshots of 89,479 nodes; at most 999 fit"):
        refuse_beyond_room(scene, 89_479)
