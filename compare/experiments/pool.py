"""What maps the points of a study: processes of this machine, or of a cluster by mpi4py."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial
from typing import TypeVar

from compare.runs.processes import Processes
from compare.runs.workers import Workers

T = TypeVar("T")
Pool = Callable[[], Executor]


def on_pool(processes: Processes, workers: int, work: Callable[[Pool | None], T]) -> T | None:
    """Return what `work` makes of a pool; of several MPI processes the first works with the others
    as its pool, and these return None when it has done.

    workers : processes of this machine where MPI has started none; 1: none but this one.
    """
    if processes.comm is None:
        return work(partial(Workers, workers) if workers > 1 else None)
    from mpi4py.futures import MPICommExecutor

    with MPICommExecutor(processes.comm, root=0) as executor:
        return None if executor is None else work(lambda: Lent(executor))


class Lent(Executor):
    """An executor that outlives those who use it."""

    def __init__(self, executor: Executor) -> None:
        self.submit = executor.submit  # type: ignore[method-assign]
