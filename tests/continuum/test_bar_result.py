"""What a run reports about itself, and that the form compiler stays silent."""

import os
import re
import subprocess
import sys

import pytest

from continuum import simulate

SILENT = """
import logging
import numpy as np
from continuum.elasticity import discretise
from continuum.mesh import Grid
assert abs(discretise(Grid(np.arange(3.0), np.zeros(1, dtype=bool)), 2).mass.sum() - 2) < 1e-12
assert not logging.getLogger().handlers and logging.getLogger().level == logging.WARNING
"""


def test_attributes_survive_netcdf(pillar, tmp_path):
    result = simulate(pillar(time__duration=0.02), "equivalent")
    expected = {"engine": "continuum-equivalent", "model": "equivalent", "dim": 1, "order": 2}
    assert {key: result.attrs[key] for key in expected} == expected
    assert all(isinstance(value, str | int | float) for value in result.attrs.values())
    result.to_netcdf(tmp_path / "result.nc")


def test_progress_ends_at_one(pillar):
    seen = []
    simulate(pillar(time__duration=0.02), "equivalent", progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 1


def test_section_on_a_joint_reads_the_same_from_either_side(pillar):
    """The recovered stress is continuous across a joint, by balance of its nodes."""
    near = 1e-6
    result = simulate(pillar(record__stress=[20.0 - near, 20.0, 20.0 + near], time__duration=0.03))
    stress = result["stress"].values
    assert stress[0] == pytest.approx(stress[1], abs=1e-5 * stress.max())
    assert stress[2] == pytest.approx(stress[1], abs=1e-5 * stress.max())


def test_form_compiler_says_nothing_and_leaves_the_root_logger_alone(tmp_path):
    """With an empty cache the compiler has all its occasions to talk. MPI may complain of the
    machine it runs on; that is not the compiler."""
    run = subprocess.run(
        [sys.executable, "-c", SILENT],
        env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert not re.search("INFO|DEBUG|build_ext|gcc", run.stdout + run.stderr)
