"""A barrier for long waits: where one process compiles, partitions or runs for all."""

from math import inf
from time import monotonic, sleep

READY = 1e-3  # s, after which a process sleeps: a balanced run waits less
SHARE = 0.1  # of the time waited so far, of each sleep
LONGEST = 0.01  # s, of a sleep


def arrive(comm, patience: float = inf) -> bool:
    """Wait until all processes of mpi4py's communicator have called this, and return whether they
    do so within `patience` (s).

    MPI's own barrier spins, and takes a core from the process that it waits for.
    """
    began, request = monotonic(), comm.Ibarrier()
    while not request.Test():
        waited = monotonic() - began
        if waited > patience:
            return False
        if waited > READY:
            sleep(min(SHARE * waited, LONGEST))
    return True
