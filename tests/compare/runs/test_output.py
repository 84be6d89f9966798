"""Files are complete or absent, and the previous file survives a failure."""

import pandas as pd
import pytest
import xarray as xr

from jointwave.cases.errors import StoppedError
from jointwave.compare.engines import solve
from jointwave.compare.runs import jobs, run
from jointwave.compare.runs.output import write, write_beside, write_dataset, write_text


def test_failed_write_leaves_the_old_file_and_no_other(tmp_path):
    path = write_text(tmp_path / "table.csv", "old")

    def half(temporary):
        temporary.write_text("ne")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError):
        write(path, half)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_table_of_other_rows_is_kept(tmp_path):
    """The sweep of another command in the same folder; one that adds rows replaces the table."""
    misfits, path = pd.DataFrame({"misfit": [0.1, 0.2]}), tmp_path / "sweep.csv"
    assert write_beside(path, misfits[:1]) == write_beside(path, misfits) == [path]
    before, kept = path.read_text(), []
    for peak in (1.0, 2.0):
        kept += write_beside(path, pd.DataFrame({"peak": [peak]}))[1:]
    assert write_beside(path, misfits) == [path, path.with_stem("sweep-3")]
    assert write_beside(path, pd.DataFrame({"peak": [2.0]})) == [path]  # sweep-1 holds it
    kept.append(path.with_stem("sweep-3"))
    assert [file.name for file in kept] == [f"sweep-{k}.csv" for k in (1, 2, 3)]
    assert kept[0].read_text() == before and set(tmp_path.iterdir()) == {path, *kept}


def test_dataset_comes_back_as_it_was(pillar, tmp_path):
    """Values, units, coordinates and attributes, with places where nothing is recorded."""
    scene = pillar(load__direction=[1.0, 0.0, 0.0], record={"stress": [], "velocity": [19.75]})
    result = solve("spatial-lattice", scene)
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
