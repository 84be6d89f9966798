"""A stopped run saves its partial result, and an earlier result is not lost."""

import pytest
import xarray as xr

from jointwave.cases.errors import StoppedError
from jointwave.compare.runs import jobs, run

KEYS = {"numerics__continuum__scheme": "implicit", "time__duration": 2e-3}


def test_what_a_stopped_run_computed_is_written_beside_its_result(pillar, tmp_path, monkeypatch):
    """Without an iteration no step converges: the first sample is all there is."""
    scene, result = pillar(**KEYS), tmp_path / "continuum-jointed.nc"
    result.write_bytes(b"CDF\2 of an earlier run")
    (job,), _ = jobs.plan([scene], [("continuum", "jointed")], tmp_path)
    monkeypatch.setattr("jointwave.continuum.stepping.newton.MOST_ITERATIONS", 0)
    with pytest.raises(StoppedError, match=r"do not converge .*; what was computed is in .*\.nc$"):
        run.execute([job], lambda fraction: None)
    assert result.read_bytes() == b"CDF\2 of an earlier run"
    with xr.open_dataset(tmp_path / "continuum-jointed.stopped.nc") as kept:
        assert kept.sizes["time"] == 1 and kept.attrs["scheme"] == "implicit"
        assert kept["stress"].sizes["stress_y"] == 1
