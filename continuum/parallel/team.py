"""The processes that share a run: what they have in common, and what they do together."""

import ctypes
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from mpi4py import MPI

from continuum.parallel.exchange import Link, add_shares
from continuum.parallel.march import run_together
from continuum.team import Alone

TAG = 0x4A57  # of messages between neighbours


class Team(Alone):
    """Several processes, each with a share of the rock and of the joints.

    Parameters
    ----------
    comm : mpi4py's communicator of those who share the run.
    freedom : int array [k], freedoms of this process that others may have too.
    name : int array [k], ascending: what each is called on every process.
    size : of the vectors of freedoms.

    Attributes
    ----------
    rank, size : which of how many processes this is.
    """

    def __init__(self, comm, freedom: np.ndarray, name: np.ndarray) -> None:
        self.comm, self.rank, self.size = comm, comm.rank, comm.size
        others = comm.allgather(name)
        self._common = [
            freedom[np.isin(name, other, assume_unique=True)] if rank != self.rank else None
            for rank, other in enumerate(others)
        ]
        self._link = self._connect(np.zeros(0, dtype=np.int64))
