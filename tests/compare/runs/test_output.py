"""Files are complete or absent, and the previous file survives a failure."""

import pytest
import xarray as xr

import dem
from compare.exact.blocks import spatial_lattice
from compare.runs.output import fields_of, write, write_fields, write_text


def test_failed_write_leaves_the_old_file_and_no_other(tmp_path):
    """The old content stays, and no temporary file is left behind."""
    path = write_text(tmp_path / "table.csv", "old")

    def half(temporary):
        temporary.write_text("ne")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError):
        write(path, half)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_dataset_comes_back_as_it_was(pillar, tmp_path):
    """Values, units, coordinates and attributes survive NetCDF."""
    result = dem.simulate(pillar(record__velocity=[19.75], time__duration=0.01))
    back = xr.load_dataset(write_fields(tmp_path / "deep" / "dem.nc", fields_of(result)))
    xr.testing.assert_identical(back, result)
    assert back.stress.attrs["units"] == "Pa" and back.attrs["critical_dt"] > back.attrs["dt"]


def test_spatial_dataset_comes_back_as_it_was(pillar, tmp_path):
    """Shear, rotation and their axes survive, with places where nothing is recorded."""
    across = {"load__direction": [1.0, 0.0, 0.0], "time__duration": 0.01}
    result = spatial_lattice.solve(pillar(record__stress=[], record__velocity=[19.75], **across))
    back = xr.load_dataset(write_fields(tmp_path / "exact.nc", fields_of(result)))
    xr.testing.assert_identical(back, result)
    assert list(back.across.values) == ["x", "z"] and back.rotation.attrs["units"] == "rad"
