"""Files are complete or absent, and the previous file survives a failure."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jointwave.cases.errors import StoppedError
from jointwave.compare.engines import solve
from jointwave.compare.runs import jobs, run
from jointwave.compare.runs.output import write, write_csv, write_dataset, write_text


def test_failed_write_leaves_the_old_file_and_no_other(tmp_path):
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


@pytest.mark.parametrize(
    "name, changes",
    [
        ("dem", {}),
        ("spatial-lattice", {"load__direction": [1.0, 0.0, 0.0], "record__stress": []}),
    ],
)
def test_dataset_comes_back_as_it_was(name, changes, pillar, tmp_path):
    """Values, units, coordinates and attributes, with places where nothing is recorded."""
    result = solve(name, pillar(record__velocity=[19.75], time__duration=0.01, **changes))
    back = xr.load_dataset(write_dataset(tmp_path / "deep" / "result.nc", result))
    xr.testing.assert_identical(back, result)
    assert back.velocity.attrs["units"] == "m/s"


def test_what_a_stopped_run_computed_is_written_beside_its_result(pillar, tmp_path, monkeypatch):
    """Without an iteration no step converges: the first sample is all there is."""
    scene = pillar(numerics__continuum__scheme="implicit", time__duration=2e-3)
    result = tmp_path / "continuum-jointed.nc"
    result.write_bytes(b"CDF\2 of an earlier run")
    (job,), _ = jobs.plan([scene], [("continuum", "jointed")], tmp_path)
    monkeypatch.setattr("jointwave.continuum.stepping.newton.MOST_ITERATIONS", 0)
    with pytest.raises(StoppedError, match=r"do not converge .*; what was computed is in .*\.nc$"):
        run.execute([job], lambda fraction: None)
    assert result.read_bytes() == b"CDF\2 of an earlier run"
    with xr.open_dataset(tmp_path / "continuum-jointed.stopped.nc") as kept:
        assert kept.sizes["time"] == 1 and kept.attrs["scheme"] == "implicit"
        assert kept["stress"].sizes["stress_y"] == 1
