"""Connection of a process to those that share freedoms with it."""

import ctypes
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from continuum.parallel.exchange import Link

TAG = 0x4A57  # of all messages between two processes: they come in the order they are sent in


class Connection(NamedTuple):
    """A link for compiled code, and the persistent requests of mpi4py that it starts."""

    link: Link
    requests: list


def connect(comm, common: list[np.ndarray]) -> Connection:
    """Return what joins a process to the others.

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
