"""Threads of long rows: where they are taken, and that they change no bit."""

import os

from jointwave import dem


def test_a_long_row_takes_the_processors_that_it_may_use(monkeypatch, row):
    """Those of this process, by default; a row of less than 40,000 blocks takes one."""
    brief = {"time__duration": 2e-4, "record": {"stress": [2.0], "energy": False}}
    long, short = row(pillar__length=2e4, **brief), row(pillar__length=19999.5, **brief)
    monkeypatch.setattr(os, "sched_getaffinity", {0: {2, 3, 5}}.__getitem__, raising=False)
    assert dem.simulate(long).threads == 3
    assert dem.simulate(short).threads == 1
    assert dem.simulate(row(**brief, numerics__dem__threads=4)).threads == 4
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert dem.simulate(long).threads == 1


def test_threads_change_no_bit_of_blocks_that_turn_by_any_angle(row, narrow, assert_alike):
    """Of 400 blocks that slide."""
    slides = {"friction_angle": 20.0, "tension": False}
    keys = {f"joints__{key}": value for key, value in slides.items()}
    keys |= {"pillar__length": 200.0, "motion__rotation": "finite", "time__duration": 2e-3}
    one, other = (dem.simulate(row(**keys, numerics__dem__threads=n)) for n in (1, 3))
    assert one.velocity.any()
    assert_alike(other, one)
