"""Executors of experiments: processes of this machine, or of a cluster by mpi4py."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import gettempdir
from typing import TypeVar

from compare.runs.checkpoint.lock import exclusive
from compare.runs.processes import Processes
from compare.runs.workers import Workers

T = TypeVar("T")
Pool = Callable[[], Executor]


def on_pool(processes: Processes, workers: int, work: Callable[[Pool | None], T]) -> T | None:
    """Return the result of `work(pool)`; the first of several MPI processes uses the others as its
    pool, and these return None when it is done.

    workers : processes of this machine, if MPI has started none; 1: only this one.
    """
    if processes.comm is None:
        return work(partial(Workers, workers) if workers > 1 else None)
    from mpi4py.futures import MPICommExecutor

    with MPICommExecutor(processes.comm, root=0) as executor:
        return None if executor is None else work(lambda: Lent(executor))


class Lent(Executor):
    """An executor that is not shut down by its users."""

    def __init__(self, executor: Executor) -> None:
        self.submit = executor.submit  # type: ignore[method-assign]


@contextmanager
def alone() -> Iterator[None]:
    """Wait until no other timed experiment is running on this machine."""
    with exclusive(Path(gettempdir()), wait=True):
        yield
