"""Worker processes: what they are started with."""

import os
import sys
from functools import partial
from multiprocessing import active_children

from jointwave.compare.runs.workers import Workers

THREADS = "OPENBLAS_NUM_THREADS"


def test_blas_has_one_thread_in_workers_unless_the_user_says_otherwise(monkeypatch):
    """The environment of the parent stays as it was."""
    for asked in (None, "3"):
        monkeypatch.delenv(THREADS, raising=False)
        if asked:
            monkeypatch.setenv(THREADS, asked)
        with Workers(1) as pool:
            assert pool.submit(os.getenv, THREADS).result() == (asked or "1")
        assert os.environ.get(THREADS) == asked


def test_workers_start_at_once_and_import_what_they_are_told():
    """Each of them has its own; what is submitted then finds the module."""
    with Workers(2, "colorsys") as pool:
        assert len(active_children()) == 2
        assert all(pool.map(partial(_has, "colorsys"), range(4)))


def _has(module, _):
    return module in sys.modules
