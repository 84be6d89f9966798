"""A run in stretches, between which it is looked at: is it still sound, how far is it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from cases.errors import UnstableError
from cases.sampling import Clock
from continuum.model import Model, State
from continuum.team import ALONE, Alone

if TYPE_CHECKING:
    from cases.snapshots import Film

FREEDOM_STEPS_BETWEEN_LOOKS = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_LOOKS = 20  # so that a runaway motion is dated to a twentieth of the scene
RUNAWAY = 100  # times the highest speed that the load can cause


def march_with_looks(
    time: Clock,
    freedoms: int,
    march: Callable[[int, int], None],
    check: Callable[[float], None],
    progress: Callable[[float], None] | None,
    film: Film | None = None,
) -> None:
    """Run all samples: `march(first, last)` takes steps first .. last - 1, then `check(t)` looks.

    Every stretch ends with the step of a sample: what follows it belongs to the next one.
    film : sees the run at every sample that it keeps; None where it keeps none.
    """
    chunk = FREEDOM_STEPS_BETWEEN_LOOKS // (freedoms * time.stride)
    chunk = max(1, min(chunk, time.samples // LEAST_LOOKS))
    stops = {0, time.samples, *range(0, time.samples, chunk)}
    if film is not None:
        stops.update(range(1, time.samples, film.every))
    step = 0
    for _, last in pairwise(sorted(stops)):
        end = (last - 1) * time.stride + 1
        march(step, end)
        step = end
        check(step * time.dt)
        if film is not None:
            film.look(last - 1)
        if progress:
            progress(last / time.samples)


def runaway_check(
    model: Model, state: State, dt: float, critical: float, team: Alone = ALONE
) -> Callable[[float], None]:
    """Return what raises UnstableError where motion has no bound any more."""
    limit = RUNAWAY * highest_speed(model, team)

    def check(t: float) -> None:
        if not team.all(np.abs(state.v).max() <= limit):
            raise UnstableError(
                f"the continuum runs away before t = {t:.4g} s "
                f"(step {dt:.4g} s, critical {critical:.4g} s)"
            )

    return check


def highest_speed(model: Model, team: Alone = ALONE) -> float:
    """Return a bound on the speed of any node, m/s; the largest number where none is known.

    Where a load on the start is all that puts energy in, d sqrt(2 E) / dt is at most |F| in the
    norm of 1 / m, and m v^2 of any node at most 2 E. Of a node that several processes share, the
    shares of F^2 / m add up to no less than the whole: (a + b)^2 / (m + n) <= a^2 / m + b^2 / n.
    """
    loaded, held = model.ends.loaded, model.ends.held
    shaken = held is not None and held.step is not None
    joints = model.interfaces
    pushed = model.weight is not None or (joints is not None and joints.prestress is not None)
    if loaded is None or shaken or pushed:
        return float(np.finfo(float).max) / RUNAWAY
    mass = model.rock.mass
    impulse = model.dt * np.abs(loaded.pressure).sum()
    drive = team.sum((loaded.share**2 / mass[loaded.freedom]).sum())
    return float(impulse * np.sqrt(drive * team.largest(1 / mass[mass > 0].min())))
