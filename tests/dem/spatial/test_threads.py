"""In whatever order tiles are stepped, every bit is the same."""

import os

from jointwave.dem.time_loop import ENOUGH_BLOCKS, thread_count


def test_a_long_row_takes_the_processors_that_it_may_use(monkeypatch):
    """Those of this process, by default; a short row takes one."""
    monkeypatch.setattr(os, "sched_getaffinity", {0: {2, 3, 5}}.__getitem__, raising=False)
    assert thread_count(None, ENOUGH_BLOCKS) == 3
    assert thread_count(None, ENOUGH_BLOCKS - 1) == 1
    assert thread_count(4, 1) == 4
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert thread_count(None, ENOUGH_BLOCKS) == 1
