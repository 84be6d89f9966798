"""Exact response of a linear system x' = A x + b f(t) from rest, by matrix exponentials.

Over each interval of length h, x(t + h) = e^{Ah} x(t) + int_0^h e^{A(h - s)} b f(t + s) ds. e^{A(h
- s)} b is an entire function of s, so its values at the Gauss-Legendre nodes determine it to
round-off; only f limits the quadrature, which is split where f is not smooth (Moler & Van Loan,
SIAM Review 45, 2003, for the exponential).
"""

from functools import cache
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import expm_multiply

from jointwave.cases.histories import LoadHistory
from jointwave.cases.size import require

NEGLIGIBLE = 1e-18  # entries of a propagator of order 1 that are below round-off
NOISE = 256 * float(np.finfo(float).eps)  # relative perturbation of the twin per interval
SMALL = 100  # states below which a full matrix is faster than a sparse one
MORE_POINTS = 7  # additional integration points of the twin
PART, TERMS = 3.5, 30  # largest |A| t of a Taylor series, and its most terms: 3.5^30 / 30! = 8e-17
SAFETY = 4.0  # factor on the difference of a solution and its twin
_points = cache(leggauss)


def twins(matrix: Any, vector: np.ndarray, load: LoadHistory, times: np.ndarray) -> np.ndarray:
    """Return x at `times`, and a twin whose difference shows the error, [2, n, m]: the twin has
    more integration points, and in every interval a relative perturbation NOISE of each state,
    always with the same sign.

    matrix, vector : A [m, m] (1/s), dense or sparse, and b [m], in units that make A's entries
        similar in size.
    load : f; smooth between its breaks, at most about one cycle per interval.
    times : equally spaced, s; the system is at rest at the first.
    """
    A, size = csr_array(matrix), len(vector)
    require(3 * 16.0 * len(times) * size, f"{len(times):,} states of {size:,} numbers")
    found = np.zeros((2, len(times), size))
    part = connected_components(A, directed=False)[1]
    for k in np.unique(part[vector != 0]):
        own = np.flatnonzero(part == k)
        found[..., own] = _coupled(A[own][:, own], vector[own], load, times)
    return found


def _coupled(A: csr_array, vector: np.ndarray, load: LoadHistory, times: np.ndarray) -> np.ndarray:
    """Return the same for states that are all coupled."""
    h = float(times[1] - times[0])
    count = 12 + ceil(h * abs(A).sum(axis=0).max())
    size = float(len(vector))
    room = 3 * size**2 + 2 * size * count + 3 * float(count) ** 2 + 5.0 * len(times) * count
    require(8 * room, f"{count:,} points of integration in each sampling interval")
    P = expm_multiply(A * h, np.eye(len(vector)))
    P = np.where(np.abs(P) > NEGLIGIBLE, P, 0.0)
    P = P if size < SMALL else csr_array(P)
    driven = []
    for points in (count, count + MORE_POINTS):
        nodes, weights = gauss(h, points)
        driven.append(
            (_moved(A, vector, h - nodes), _load_on_nodes(load, times[:-1], h, nodes, weights))
        )
    off = 1 + NOISE * np.random.default_rng(0).uniform(-1, 1, len(vector))
    off = np.stack([np.ones(len(vector)), off], axis=1)
    x = np.zeros((len(vector), 2))
    states = np.stack([np.pad(F @ G.T, ((1, 0), (0, 0))) for G, F in driven], axis=-1)
    for n, share in enumerate(states[1:], 1):
        x = off * (P @ x + share)
        states[n] = x
    return np.moveaxis(states, -1, 0)


def bound(one: np.ndarray, twin: np.ndarray) -> np.ndarray:
    """Return a bound on the root-mean-square error of waveforms [..., n] from their twins."""
    apart = np.sqrt(np.mean((one - twin) ** 2, axis=-1))
    return SAFETY * apart + 4 * np.finfo(float).eps * np.abs(one).max(axis=-1, initial=0.0)


def _moved(A, vector: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return e^{A t} b at all times t [n] (s), [m, n], by Taylor series over equal parts of each
    time. scipy's `expm_multiply` takes one time only, and longer to prepare than to multiply."""
    parts = max(1, ceil(abs(A).sum(axis=0).max() * times.max() / PART))
    found = np.repeat(vector[:, None], len(times), axis=1)
    for _ in range(parts):
        term, before = found, np.inf
        for j in range(1, TERMS + 1):
            term = (A @ term) * (times / (parts * j))
            found = found + term
            size = np.abs(term).max()
            if before + size <= 2.0**-53 * np.abs(found).max():
                break
            before = size
    return found


def gauss(h: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss-Legendre points and weights of [0, h]."""
    x, w = _points(count)
    return h * (x + 1) / 2, h * w / 2


def _load_on_nodes(load, starts, h, nodes, weights) -> np.ndarray:
    """Return weights [intervals, nodes] that integrate a smooth function times the load; in an
    interval with breaks, from the load's piecewise projection on polynomials."""
    shares, count = weights * load.value(starts[:, None] + nodes), len(nodes)
    project = (2 * np.arange(count) + 1) * legvander(2 * nodes / h - 1, count - 1)
    at = (np.asarray(load.breaks) - starts[0]) / h
    inside = np.floor(at)
    for n in np.unique(inside[(inside >= 0) & (inside < len(starts))]).astype(int):
        shares[n] = 0
        for a, b in pairwise([0.0, *h * (at[inside == n] - n), h]):
            s, w = gauss(b - a, count)
            basis = legvander(2 * (a + s) / h - 1, count - 1) @ project.T * (weights / h)
            shares[n] += (w * load.value(starts[n] + a + s)) @ basis
    return shares
