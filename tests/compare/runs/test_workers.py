"""Worker processes: what they are started with."""

import os

from compare.runs.workers import Workers

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
