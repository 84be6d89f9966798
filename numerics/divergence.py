"""The divergence monitor, which stops a run that exceeds its bounds.

Speeds cannot exceed what all forces together can cause, and energy cannot increase without work.
"""

from typing import Any, NamedTuple

import numpy as np

EVERY = 96  # steps before a sample of too much energy that are not trusted either
RUNAWAY = 100.0  # over the speed that forces can cause: leapfrog overshoots at the critical step
CREATED = 0.1  # of the largest term of the ledger: more than any bounded run of any scheme gains
LAST_DIGITS = 1e-8  # of the ledger's initial terms, from which small changes are differences

SPEED, ENERGY = 0, 1  # the exceeded bound


class Guard(NamedTuple):
    """The bounds of a run, and the finding.

    limit : float array, the largest speed of each kind, m/s (or rad/s, kg m2/s).
    peak : float array [1], the largest change of a ledger's term so far, J.
    found : int64 array [3], the step at which a bound was found exceeded (-1: none), which one
        (SPEED or ENERGY), and the last valid step.
    """

    limit: np.ndarray
    peak: np.ndarray
    found: np.ndarray


def guard(speeds: Any) -> Guard:
    """Return the guard of a run for `RUNAWAY` times the speeds that its forces can cause."""
    with np.errstate(over="ignore"):
        limit = np.minimum(RUNAWAY * np.atleast_1d(speeds), np.finfo(float).max)
    return Guard(limit, np.zeros(1), np.array([-1, SPEED, -1]))


def audit(guard: Guard, energy: np.ndarray, first: int, last: int, stride: int) -> None:
    """Check samples first .. last - 1 of a ledger [term, sample], `stride` steps apart; the last
    term is the work. The earliest finding is kept."""
    with np.errstate(over="ignore", invalid="ignore"):
        gained = energy[:, first:last] - energy[:, :1]
        peak = np.fmax.accumulate(np.append(guard.peak, np.fmax.reduce(np.abs(gained))))
        most = np.fmax.reduce(np.abs(energy[:, first:last]))
        lost = gained[:-1].sum(axis=0) - gained[-1] > CREATED * peak[1:] + LAST_DIGITS * most
    guard.peak[0] = peak[-1]
    if lost.any():
        n, found = (first + int(lost.argmax())) * stride, guard.found
        if found[0] < 0 or n < found[0]:
            found[:] = n, ENERGY, n - EVERY - 1


def speed_that(*motions: float) -> float:
    """Return a bound on sqrt(2 E / m) from everything that adds energy to a body.

    Each is a speed: an impulse over the mass, a velocity of the base, sqrt(2 E / m) of what is
    stored. They add up: d sqrt(2 E) / dt is at most |F| in the norm of 1 / m.
    """
    return float(sum(abs(motion) for motion in motions))
