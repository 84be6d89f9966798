"""The divergence monitor: stops a run that exceeds its bounds with a one-line error.

Speeds are bounded by the sum of all forces, and energy cannot increase without work.
"""

from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import StoppedError, placed
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene

EVERY = 96  # steps before a sample of too much energy that count as invalid, too
RUNAWAY = 100.0  # times the speed that forces can cause: leapfrog overshoots at the critical step
CREATED = 0.1  # of the largest change of a term of the ledger: no bounded run gains as much
LAST_DIGITS = 1e-8  # of the ledger's largest term: allows for its round-off
HUGE = 1e100  # an amplitude whose square may overflow

SPEED, ENERGY = 0, 1  # the exceeded bound


class Guard(NamedTuple):
    """The bounds of a run, and the first violation.

    limit : the largest speed of each kind, m/s (or rad/s, kg m2/s).
    peak : [1], the largest change of a ledger's term so far, J.
    found : int64 [3], the step at which a bound was exceeded (-1: none), which one (SPEED or
        ENERGY), and the last valid step.
    """

    limit: np.ndarray
    peak: np.ndarray
    found: np.ndarray


class Guarded(NamedTuple):
    """A run: scene, engine in words, the scene key that sets the step, clock, critical step, s."""

    scene: AnyScene
    engine: str
    key: str
    time: Clock
    critical: float


def guard(speeds: Any) -> Guard:
    """Return the guard of a run with limits of `RUNAWAY` times these speeds."""
    with np.errstate(over="ignore"):
        limit = np.minimum(RUNAWAY * np.atleast_1d(speeds), np.finfo(float).max)
    return Guard(limit, np.zeros(1), np.array([-1, SPEED, -1]))


def audit(guard: Guard, energy: np.ndarray, first: int, last: int, stride: int) -> None:
    """Check the ledger [term, sample] in samples first .. last - 1, `stride` steps apart; the last
    term is the work. Keep the earliest violation."""
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


def check(
    guard: Guard,
    run: Guarded,
    samples: tuple[int, int],
    energy: np.ndarray | None,
    speed: np.ndarray,
    places: np.ndarray,
) -> None:
    """Raise StoppedError, with the valid samples, if samples first .. last - 1 exceed bounds.

    energy : the ledger [term, sample]; None where it is not exact. speed : largest at each place
    after these samples [n], in the unit of the guard's limit. places : [n, d], m.
    """
    (first, last), stride, found = samples, run.time.stride, guard.found
    if energy is not None:
        audit(guard, energy, first, last, stride)
    if found[0] < 0 and not speed.max(initial=0.0) <= guard.limit[0]:
        found[:] = last * stride, SPEED, first * stride - 1
    if found[0] >= 0:
        raise _stopped(run, found.tolist(), places[int(np.nan_to_num(speed, nan=np.inf).argmax())])


def _stopped(run: Guarded, found: list[int], place: Any) -> StoppedError:
    """Return the error of a run from `Guard.found`; place : of the fastest point, m."""
    (step, what, sound), scene, dt = found, run.scene, run.time.dt
    name = f"{scene.where}, {scene.name}" if scene.name else scene.where
    error = StoppedError(
        f"{name}: {run.engine} {'gained energy' if what == ENERGY else 'diverged'} at t = "
        f"{step * dt:.6g} s, step {step} of {dt:.4g} s, fastest at {placed(place)} m: {_cause(run)}"
    )
    error.samples = max(0, sound) // run.time.stride + 1
    return error


def _cause(run: Guarded) -> str:
    dt, critical = run.time.dt, run.critical
    if dt > 0.9999 * critical:
        return (
            f"the step is {dt / critical:.4g} times the critical step {critical:.4g} s; "
            f"set {run.key} to at most 0.9"
        )
    if any(abs(one.amplitude or 0.0) > HUGE for one in run.scene.pulses):
        return "numbers overflow; use a smaller load.amplitude"
    return (
        "joints open, close, stiffen or slide within a step, or the scene exceeds the limits of "
        f"the scheme; {'halve' if run.key.endswith('fraction') else 'double'} {run.key}"
    )


def speed_that(*motions: float) -> float:
    """Return a bound on sqrt(2 E / m) of a body: the sum of all contributions to it.

    Each is a speed: an impulse over the mass, a velocity of the base, sqrt(2 E / m) of stored
    energy. They add up since d sqrt(2 E) / dt is at most |F| in the norm of 1 / m.
    """
    return float(sum(abs(motion) for motion in motions))
