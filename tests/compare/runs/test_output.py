"""Files are complete or absent, and the previous file survives a failure."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jointwave import dem
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.runs.output import write, write_csv, write_dataset, write_text


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


@pytest.mark.parametrize("rows", [0, 1, 25_000])
def test_a_table_of_numbers_is_written_as_one_with_text(tmp_path, rows):
    """Formatted together or one by one, numbers and names of columns look the same."""
    values = np.random.default_rng(0).standard_normal((rows, 2)) * 10.0 ** np.arange(-20, 20, 20)
    numbers = pd.DataFrame(values, columns=["stress, dem (Pa)", "=v"])
    numbers.iloc[:1] = np.inf, -0.0
    lines = write_csv(tmp_path / "a.csv", numbers, 6).read_text().splitlines()
    mixed = write_csv(tmp_path / "b.csv", numbers.assign(word="x"), 6).read_text().splitlines()
    assert mixed[0] == f"{lines[0]},word" and len(lines) == rows + 1
    assert mixed[1:] == [f"{line},x" for line in lines[1:]]


def test_dataset_comes_back_as_it_was(pillar, tmp_path):
    """Values, units, coordinates and attributes survive NetCDF."""
    result = dem.simulate(pillar(record__velocity=[19.75], time__duration=0.01))
    back = xr.load_dataset(write_dataset(tmp_path / "deep" / "dem.nc", result))
    xr.testing.assert_identical(back, result)
    assert back.stress.attrs["units"] == "Pa" and back.attrs["critical_dt"] > back.attrs["dt"]


def test_spatial_dataset_comes_back_as_it_was(pillar, tmp_path):
    """Shear, rotation and their axes survive, with places where nothing is recorded."""
    across = {"load__direction": [1.0, 0.0, 0.0], "time__duration": 0.01}
    result = row_of_blocks.solve(pillar(record__stress=[], record__velocity=[19.75], **across))
    back = xr.load_dataset(write_dataset(tmp_path / "exact.nc", result))
    xr.testing.assert_identical(back, result)
    assert list(back.across.values) == ["x", "z"] and back.rotation.attrs["units"] == "rad"
