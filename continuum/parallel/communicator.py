"""The processes that share a run: common degrees of freedom and collective operations."""

import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property

import numpy as np
from mpi4py import MPI
from scipy.sparse import csr_matrix

from jointwave.continuum.explicit.march import march
from jointwave.continuum.parallel.exchange import TAG, add_shares, connect, release
from jointwave.continuum.parallel.identity import Border, joined
from jointwave.continuum.parallel.serial import Pieces, Serial, T
from jointwave.numerics.divergence import EVERY
from jointwave.numerics.mpi_barrier import arrive


class Communicator(Serial):
    """Several processes, each with a share of the rock and of the joints; collective operations are
    documented in `Serial`.

    Parameters
    ----------
    comm : mpi4py's communicator of the processes that share the run.
    freedom : int array, the degrees of freedom of this process, without those of ghosts only.
    border : int array [k], those of them that other processes may have too.
    name : int array [k], ascending: their global names.
    length : of the vectors of degrees of freedom.
    meeting : the cells where processes meet, and the identity of their nodes.

    Attributes
    ----------
    freedom, length : as given. rank, size : of this process and the communicator.
    """

    def __init__(
        self,
        comm,
        freedom: np.ndarray,
        border: np.ndarray,
        name: np.ndarray,
        length: int,
        meeting: Border,
    ) -> None:
        self.comm, self.rank, self.size = comm, comm.rank, comm.size
        self.freedom, self.length, self._meeting = freedom, length, meeting
        self._common = [
            border[np.isin(name, other, assume_unique=True)] for other in comm.allgather(name)
        ]
        self._all = connect(comm, self._common)
        weakref.finalize(self, release, self._all)

    def total(self, share: np.ndarray) -> np.ndarray:
        found = np.array(share, dtype=float)
        for values in found.reshape(-1, self.length):
            _check(add_shares(self._all.link, values))
        return found

    def sum(self, value: float) -> float:
        return self.comm.allreduce(value)

    def largest(self, value: float) -> float:
        return self.comm.allreduce(value, MPI.MAX)

    def of_largest(self, value: float, about: T) -> T:
        return max(self.comm.allgather((value, -self.rank, about)))[2]

    def all(self, holds: bool) -> bool:
        return self.comm.allreduce(bool(holds), MPI.LAND)

    def same(self, value: T) -> T:
        return self.comm.bcast(value)

    def assembled(self, share: csr_matrix) -> csr_matrix | None:
        """Return the sum of matrices [n, n], numbered by `number`, on the first process."""
        entries = share.tocoo()
        row, column = self.number[entries.row], self.number[entries.col]
        there = (row >= 0) & (column >= 0)
        size = self.degrees_of_freedom
        found = self._sent_to_first([row[there], column[there], entries.data[there]])
        if not found:
            return None
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return csr_matrix((values, (rows, columns)), (size, size))

    def beside(self, rows: np.ndarray) -> tuple[np.ndarray, slice]:
        parts = self.comm.allgather(rows)
        first = sum(len(part) for part in parts[: self.rank])
        return np.concatenate(parts), slice(first, first + len(rows))

    def gather(self, waves: np.ndarray) -> None:
        """Replace shares of waveforms by their sums over all processes, bit-identical on all."""
        whole = np.empty_like(waves)
        self.comm.Reduce(waves, whole)
        self.comm.Bcast(whole)
        waves[:] = whole

    def joined(self, pieces: Pieces) -> Pieces | None:
        cell, table, of_cells, of_nodes = pieces
        found = self._sent_to_first([cell, table, *of_cells, *of_nodes])
        last = 2 + len(of_cells)
        gathered = [Pieces(a[0], a[1], tuple(a[2:last]), tuple(a[last:])) for a in found]
        return joined(gathered, self._meeting) if gathered else None

    @contextmanager
    def in_turn(self) -> Iterator[None]:
        local = self.comm.Split_type(MPI.COMM_TYPE_SHARED)
        if local.rank:
            arrive(local)
        try:
            yield
        finally:
            if not local.rank:
                arrive(local)
            arrive(self.comm)
            local.Free()

    def leapfrog(self, model, state, samples, stride, limits) -> Callable[[int, int], object]:
        """Return a function of (first, last) that takes steps, as `explicit.march.march` does.

        Degrees of freedom with prescribed motion need no force; they keep their shares of it, which
        sum to the driving force.
        """
        fixed = np.zeros(0) if model.ends.fixed is None else model.ends.fixed.freedom
        connection = connect(self.comm, [f[~np.isin(f, fixed)] for f in self._common])
        weakref.finalize(self, release, connection)
        steps = march(model, state, samples, stride, limits, connection.link)

        def run(first: int, last: int) -> None:
            for n in range(first, max(last, first + 1), EVERY):
                _check(steps(n, min(n + EVERY, last)))
                # Processes compile one after the other, without taking a step.
                if limits is not None and last > first and self.any(bool(limits.found[0] >= 0)):
                    return

        return run

    @cached_property
    def mine(self) -> np.ndarray:
        """The degrees of freedom that no process of lower rank has, int array."""
        lower = np.concatenate([np.zeros(0, dtype=np.int64), *self._common[: self.rank]])
        return np.setdiff1d(self.freedom, lower)

    @cached_property
    def number(self) -> np.ndarray:
        """Global numbers of the freedoms, int array [length]; -1 for padding and ghosts."""
        found = np.full(self.length, -1)
        found[self.freedom] = self.numbered(self.mine)[self.freedom]
        return found

    def numbered(self, mine: np.ndarray) -> np.ndarray:
        """Return consecutive numbers [length] of the entries that are `mine` on each process."""
        found = np.zeros(self.length)
        found[mine] = (self.comm.exscan(mine.size) or 0) + np.arange(mine.size)
        return np.rint(self.total(found)).astype(np.int64)

    @cached_property
    def degrees_of_freedom(self) -> int:
        """Total number of degrees of freedom."""
        return 1 + int(self.largest(self.number.max()))

    def count(self, here: int) -> int:
        """Return the total number of degrees of freedom."""
        return self.degrees_of_freedom

    def on_first(self, share: np.ndarray) -> np.ndarray:
        """Return the sum of values as one vector [n] by `number`, on the first process only."""
        found = np.zeros(self.degrees_of_freedom)
        found[self.number[self.freedom]] = share[self.freedom]
        whole = np.empty_like(found)
        self.comm.Reduce(found, whole)
        return whole

    def _sent_to_first(self, arrays: list[np.ndarray]) -> list[list[np.ndarray]]:
        """Return the arrays of every process on the first one, an empty list on others.

        One message per array: pickled together they might exceed the maximum message length.
        """
        shapes = self.comm.gather([(a.shape, a.dtype) for a in arrays])
        if self.rank:
            for array in arrays:
                self.comm.Send(np.ascontiguousarray(array), 0, TAG)
            return []
        found = [arrays]
        for rank in range(1, self.size):
            found.append([np.empty(*kind) for kind in shapes[rank]])
            for array in found[-1]:
                self.comm.Recv(array, rank, TAG)
        return found


def _check(code: int) -> None:
    if code:
        raise MPI.Exception(code)
