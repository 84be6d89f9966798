"""In whatever order tiles are stepped, every bit is the same."""

import os

from jointwave import dem


def test_a_long_row_takes_the_processors_that_it_may_use(monkeypatch, row):
    """Those of this process, by default; a row of less than 20,000 blocks takes one."""
    brief = {"time__duration": 2e-4, "record": {"stress": [2.0], "energy": False}}
    long, short = row(pillar__length=1e4, **brief), row(pillar__length=9999.5, **brief)
    monkeypatch.setattr(os, "sched_getaffinity", {0: {2, 3, 5}}.__getitem__, raising=False)
    assert dem.simulate(long).threads == 3
    assert dem.simulate(short).threads == 1
    assert dem.simulate(row(**brief, numerics__dem__threads=4)).threads == 4
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert dem.simulate(long).threads == 1
