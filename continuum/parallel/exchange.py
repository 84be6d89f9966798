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


def _from_mpi(name: str, signature):
    """Return a function of MPI for compiled code, which finds it by name when it is loaded."""
    function = getattr(ctypes.CDLL(MPI.__file__), name)
    address = ctypes.cast(function, ctypes.c_void_p).value
    llvmlite.binding.add_symbol(f"jointwave_{name}", address)
    return types.ExternalFunction(f"jointwave_{name}", signature)


start_all = _from_mpi("MPI_Startall", types.intc(types.intc, types.voidptr))
wait_all = _from_mpi("MPI_Waitall", types.intc(types.intc, types.voidptr, types.voidptr))


class Link(NamedTuple):
    """What joins a process to the others.

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
    """Add what the others have sent to a process's own shares.

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
