"""Sums over the processes that have a freedom, compiled: a few numbers at every step.

MPI's own functions are called by the compiled code, for the way through Python would take longer
than the step. Persistent requests leave nothing to be told to them but an address.
"""

import ctypes
from typing import NamedTuple

import llvmlite.binding
import numpy as np
from mpi4py import MPI
from numba import types

from numerics.jit import inlined, jitted

TAG = 0x4A57  # of all messages between two processes: they come in the order they are sent in


def _from_mpi(name: str, signature):
    """Return a function of MPI for compiled code, which finds it by name when it is loaded."""
    function = getattr(ctypes.CDLL(MPI.__file__), name)
    address = ctypes.cast(function, ctypes.c_void_p).value
    llvmlite.binding.add_symbol(f"jointwave_{name}", address)
    return types.ExternalFunction(f"jointwave_{name}", signature)


start_all = _from_mpi("MPI_Startall", types.intc(types.intc, types.voidptr))
wait_all = _from_mpi("MPI_Waitall", types.intc(types.intc, types.voidptr, types.voidptr))


class Link(NamedTuple):
    """The connections of a process to the others.

    freedom : int array [k], own freedoms that others have too. sum : float array [k].
    source : int array [s], the freedoms to send, process by process; sent : float array [s].
    place, value : arrays [r], what comes from every process in turn, this one among them: which of
        `freedom` it adds to. own : where its own values begin.
    calls : how many requests there are. requests, statuses : bytes that MPI reads and writes.
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
    """A link for compiled code, and the persistent requests of mpi4py that it starts."""

    link: Link
    requests: list


def connect(comm, common: list[np.ndarray]) -> Connection:
    """Return the connections of a process to the others.

    common : for each rank of `comm` the freedoms (int array) in common with it, in an order that
        both agree on; that of the process itself does not count.
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
    """Give the requests back to MPI, which may have changed their handles."""
    size, handles = MPI._sizeof(MPI.Request), connection.link.requests.tobytes()
    for k, request in enumerate(connection.requests):
        ctypes.memmove(MPI._addressof(request), handles[k * size : (k + 1) * size], size)
        request.Free()


def _handles(requests: list) -> np.ndarray:
    """Return the handles of requests side by side, as MPI takes them."""
    size = MPI._sizeof(MPI.Request)
    handles = b"".join(ctypes.string_at(MPI._addressof(r), size) for r in requests)
    return np.frombuffer(handles, dtype=np.uint8).copy()


@jitted
def add_shares(link, values):
    """Replace a process's shares of values on common freedoms by their sums.

    Returns MPI's error code, 0 without.
    """
    failed = send(link, values)
    return failed or receive(link, values)


@inlined
def send(link, values):
    """Begin to send a process's shares of values to all who have the freedoms too."""
    for k in range(link.source.size):
        link.sent[k] = values[link.source[k]]
    return start_all(link.calls, link.requests.ctypes)


@inlined
def receive(link, values):
    """Add the contributions received from other processes.

    All who have a freedom add in the order of their ranks, and come to the same bits.
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
