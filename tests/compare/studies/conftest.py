"""The command as tests of studies run it, and a small study of a short pillar."""

from typing import Any

import pytest

from jointwave.compare.studies.study import Study


@pytest.fixture
def command(jointwave, tmp_path, monkeypatch):
    """Return `jointwave`, which runs in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return jointwave


SHORT: dict[str, Any] = {
    "pillar.length": 5.0,
    "time.duration": 0.01,
    "record.interval": 1e-4,
    "record.stress": [2.0],
    "record.energy": False,
    "load": {"shape": "ricker", "amplitude": 1e6, "period": 2e-3},
}
STEPS = {"numerics.dem.step_fraction": [0.4, 0.2, 0.1, 0.05]}


@pytest.fixture
def study():
    """Return a function that gives a study of five metres of the paper's pillar: rigid blocks at
    four steps against their exact chain; keys of the study and of its only curve changed."""

    def make(curves=None, **keys):
        blocks = {"label": "blocks", "method": "dem", "own": "lattice", "vary": STEPS, "order": 2}
        table = {"title": "short", "scene": "guo-li-2002/fig-03", "changes": SHORT}
        return Study.model_validate(table | {"curves": curves or [blocks]} | keys)

    return make
