"""The divergence monitor, which stops a run within its kernel where it exceeds its bounds.

Speeds cannot exceed what all forces together can cause, and energy cannot increase without work.
Kernels check the speeds every 96 steps, at the cost of reading all velocities once, and leapfrog,
whose ledger is exact, also the energy of its last sample.
"""

from typing import Any, NamedTuple

import numpy as np

from jointwave.joints.formula import formula

EVERY = 96  # steps, at most, between two checks of the speeds
RUNAWAY = 100.0  # over the speed that forces can cause: leapfrog overshoots at the critical step
CREATED = 0.1  # of the largest term of the ledger: more than any bounded run of any scheme gains
LAST_DIGITS = 1e-8  # of the ledger's initial terms, from which small changes are differences

SPEED, ENERGY = 0, 1  # the exceeded bound


class Guard(NamedTuple):
    """The bounds of a run, and the finding.

    limit : int64 array, the bits of the largest speed of each kind, m/s (or rad/s, kg m2/s).
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
    return Guard(limit.view(np.int64), np.zeros(1), np.array([-1, SPEED, -1]))


def look(guard: Guard, speeds: Any, n: int) -> None:
    """Check the largest speed of each kind after n steps, for any n."""
    limit = guard.limit.view(np.float64)
    if guard.found[0] < 0 and not np.all(np.atleast_1d(speeds) <= limit):
        guard.found[:] = n, SPEED, n - EVERY - 1


def audit(guard: Guard, energy: np.ndarray, first: int, last: int, stride: int) -> None:
    """Check samples first .. last - 1 of a ledger, `stride` steps apart, by `gains_energy`; the
    earliest finding is kept."""
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


@formula
def out_of_bounds(v, limit):
    """Return whether a magnitude is above the limit, or NaN."""
    found = 0
    for i in range(v.size):
        found += not abs(v[i]) <= limit
    return found > 0


@formula
def gains_energy(peak, energy, s):
    """Return whether sample s of a ledger [term, sample] has gained energy.

    peak : float array [1], the largest change of a term so far, J.
    """
    work, created, most = energy.shape[0] - 1, 0.0, 0.0
    for k in range(work + 1):
        now = energy[k, s]
        gained = now - energy[k, 0]
        created += -gained if k == work else gained
        peak[0] = abs(gained) if abs(gained) > peak[0] else peak[0]
        most = abs(now) if abs(now) > most else most
    return created > CREATED * peak[0] + LAST_DIGITS * most


@formula
def note(found, n, what, sound):
    """Keep the first finding."""
    if found[0] < 0:
        found[0], found[1], found[2] = n, what, sound
