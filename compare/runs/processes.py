"""The processes of one command: this one only, or all those started by mpiexec.

All execute the same command. Only the first process prints, and does work that is not shared.
"""

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from math import inf
from pathlib import Path
from time import monotonic, sleep
from typing import Any, NoReturn, TextIO, TypeVar

from jointwave.cases.errors import SceneError

#: Variables with the number of processes: Open MPI, MPICH and derivatives, MVAPICH.
SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE")
#: Variable set by PMIx, which does not give the number of processes.
STARTED = "PMIX_RANK"

PATIENCE = 5.0  # s; a failure common to all processes occurs at nearly the same time
GRACE = 0.5  # s; aborting may lose output that the launcher has not forwarded yet
READY = 1e-3  # s, after which a waiting process sleeps; a balanced run waits less
SHARE, LONGEST = 0.1, 0.01  # length of each sleep: of the time waited so far, and at most, s

T = TypeVar("T")


class Processes:
    """The processes of a command.

    comm : mpi4py's communicator of all of them; None for a single process. rank : of this one.
    """

    def __init__(self, comm: Any = None) -> None:
        self.comm = comm
        self.rank: int = 0 if comm is None else comm.rank
        self.size: int = 1 if comm is None else comm.size
        self.is_first = self.rank == 0
        self._stderr: TextIO | None = None
        # For messages about the command itself; runs use `comm`.
        self._own: Any = None if comm is None else comm.Dup()

    @property
    def stderr(self) -> TextIO:
        """Stream for errors, also of a muted process."""
        return self._stderr or sys.stderr

    def mute_others(self) -> None:
        """Discard the output of all processes except the first."""
        if not self.is_first:
            self._stderr = sys.stderr
            sys.stdout = sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115

    def all_of(self, value: T) -> list[T]:
        """Return the values of all processes."""
        return [value] if self._own is None else self._own.allgather(value)

    def together(self, work: Callable[[], object]) -> None:
        """Do `work` on every process; raise the exception of any on all, once all are done."""
        _, error = _tried(work)
        for found in self.all_of(error):
            if found is not None:
                raise found

    def told_by_first(self, work: Callable[[], T]) -> T:
        """Do `work` on the first process; return its result, or raise its exception, on all."""
        done: Any = self.by_first(work)
        return done if self._own is None else self._own.bcast(done)

    def by_first(self, work: Callable[[], T]) -> T | None:
        """Do `work` on the first process while the others sleep; return its result there, None
        elsewhere. An exception is raised on all."""
        if self._own is None:
            return work()
        done, error = _tried(work) if self.is_first else (None, None)
        arrive(self._own)
        if error := self._own.bcast(error):
            raise error
        return done

    def fail(self, message: str, code: int) -> NoReturn:
        """Print one line and exit with a code; abort if not all processes arrive here in time."""
        if self.is_first:
            self._tell(message)
        if self._own is not None and not arrive(self._own, PATIENCE):
            if not self.is_first:
                self._tell(message)
            sleep(GRACE)
            self._own.Abort(code)
        sys.exit(code)

    def _tell(self, message: str) -> None:
        with suppress(OSError):  # the reader may have closed it
            print(message, file=self.stderr, flush=True)


def _tried(work: Callable[[], T]) -> tuple[T | None, Exception | None]:
    """Return the result of work, and the exception that it raised."""
    try:
        return work(), None
    except Exception as error:
        return None, error


def arrive(comm: Any, patience: float = inf) -> bool:
    """Wait until all processes arrive; return whether they do so within `patience`, s.

    For long waits while one process compiles, partitions or runs for all: MPI's own barrier spins
    and so takes a core from the working process.
    """
    began, request = monotonic(), comm.Ibarrier()
    while not request.Test():
        waited = monotonic() - began
        if waited > patience:
            return False
        if waited > READY:
            sleep(min(SHARE * waited, LONGEST))
    return True


ALONE = Processes()


@cache
def started() -> Processes:
    """Return the processes of this command; raises SceneError if they cannot communicate."""
    counts = [int(os.environ[name]) for name in SIZES if name in os.environ]
    if not counts and STARTED not in os.environ:
        return Processes()
    try:
        from mpi4py import MPI
    except ImportError as error:
        raise SceneError("mpiexec", "", None, f"needs mpi4py ({error})") from None
    if MPI.COMM_WORLD.size < max(counts, default=1):
        allowed = "belongs to another MPI than mpi4py, which sees one process"
        raise SceneError("mpiexec", "-n", max(counts), allowed)
    return Processes(MPI.COMM_WORLD if MPI.COMM_WORLD.size > 1 else None)
