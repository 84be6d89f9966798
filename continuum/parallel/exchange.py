"""Sums over the processes that share a degree of freedom, compiled: a few numbers at every step.

The compiled code calls MPI's own functions, because a call through Python would take longer than
the step. With persistent requests, a call needs only an address.
"""

import ctypes
from typing import NamedTuple

import llvmlite.binding
import numpy as np
from mpi4py import MPI
from numba import types

from jointwave.joints.formula import formula
from jointwave.numerics.jit import jitted

TAG = 0x4A57  # of all messages between two processes, which arrive in the order of sending


def _from_mpi(name: str, signature):
    """Return a function of MPI for compiled code, which resolves it by name when loaded."""
    function = getattr(ctypes.CDLL(MPI.__file__), name)
    address = ctypes.cast(function, ctypes.c_void_p).value
    llvmlite.binding.add_symbol(f"jointwave_{name}", address)
    return types.ExternalFunction(f"jointwave_{name}", signature)


start_all = _from_mpi("MPI_Startall", types.intc(types.intc, types.voidptr))
wait_all = _from_mpi("MPI_Waitall", types.intc(types.intc, types.voidptr, types.voidptr))


class Link(NamedTuple):
    """The connections of a process to the others.

    freedom : int array [k], own degrees of freedom shared with others. sum : float array [k].
    source : int array [s], those to send, process by process; sent : float array [s].
    place, value : arrays [r], values from each process in turn, including this one, and the index
    in `freedom` to which each adds. own : start of its own values.
    calls : number of requests. requests, statuses : bytes that MPI reads and writes.
    """

    freedom: np.ndarray
    sum: np.ndarray
    source: np.ndarray
    sent: np.ndarray
    place: np.ndarray
    value: np.ndarray
    own: int
    calls: int
    requests: np.ndarray
    statuses: np.ndarray


class Connection(NamedTuple):
    """A link for compiled code, and its persistent requests of mpi4py."""

    link: Link
    requests: list


def connect(comm, common: list[np.ndarray]) -> Connection:
    """Return the connections of a process to the others.

    common : for each rank of `comm` the degrees of freedom (int array) shared with it, in the same
    order on both; the entry of the process itself is ignored.
    """
    none = np.zeros(0, dtype=np.int64)
    others = [r for r, f in enumerate(common) if f.size and r != comm.rank]
    source = np.concatenate([none, *(common[r] for r in others)])
    freedom = np.unique(source)
    place = [
        np.arange(freedom.size) if r == comm.rank else np.searchsorted(freedom, f)
        for r, f in enumerate(common)
    ]
    ends = np.cumsum([p.size for p in place])
    value, sent = np.zeros(ends[-1]), np.zeros(source.size)
    arriving = np.split(value, ends[:-1])
    leaving = np.split(sent, np.cumsum([common[r].size for r in others])[:-1])
    requests = [comm.Recv_init(arriving[r], r, TAG) for r in others]
    requests += [comm.Send_init(part, r, TAG) for r, part in zip(others, leaving, strict=False)]
    link = Link(
        freedom=freedom,
        sum=np.zeros(freedom.size),
        source=source,
        sent=sent,
        place=np.concatenate(place),
        value=value,
        own=int(ends[comm.rank] - freedom.size),
        calls=len(requests),
        requests=_handles(requests),
        statuses=np.zeros(MPI._sizeof(MPI.Status) * len(requests), dtype=np.uint8),
    )
    return Connection(link, requests)


def release(connection: Connection) -> None:
    """Return the requests to MPI, which may have changed their handles."""
    size, handles = MPI._sizeof(MPI.Request), connection.link.requests.tobytes()
    for k, request in enumerate(connection.requests):
        ctypes.memmove(MPI._addressof(request), handles[k * size : (k + 1) * size], size)
        request.Free()


def _handles(requests: list) -> np.ndarray:
    """Return the handles of requests as a contiguous array for MPI."""
    size = MPI._sizeof(MPI.Request)
    handles = b"".join(ctypes.string_at(MPI._addressof(r), size) for r in requests)
    return np.frombuffer(handles, dtype=np.uint8).copy()


@jitted
def add_shares(link, values):
    """Replace a process's shares of values on shared degrees of freedom by their sums.

    Returns MPI's error code, 0 for success.
    """
    failed = send(link, values)
    return failed or receive(link, values)


@formula
def send(link, values):
    """Start sending a process's shares of values to all processes that share them."""
    for k in range(link.source.size):
        link.sent[k] = values[link.source[k]]
    return start_all(link.calls, link.requests.ctypes)


@formula
def receive(link, values):
    """Add the contributions received from other processes.

    All processes add in the order of ranks, so that the sums are bit-identical.
    """
    for i in range(link.freedom.size):
        link.value[link.own + i] = values[link.freedom[i]]
        link.sum[i] = 0.0
    failed = wait_all(link.calls, link.requests.ctypes, link.statuses.ctypes)
    for k in range(link.place.size):
        link.sum[link.place[k]] += link.value[k]
    for i in range(link.freedom.size):
        values[link.freedom[i]] = link.sum[i]
    return failed
