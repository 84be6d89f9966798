"""The time loop: a run in stretches, after each of which it is checked, saved and reported."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from cases.sampling import Clock
from numerics.checkpoint import Keeper, begin, show

if TYPE_CHECKING:
    from results.snapshots import Film

FREEDOM_STEPS_AT_ONCE = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_STRETCHES = 20  # however short the run


def run_in_stretches(
    time: Clock,
    work: int,
    march: Callable[[int, int], object],
    check: Callable[[int, int], None],
    parts: Any,
    progress: Callable[[float], None] | None,
    film: Film | None,
    keeper: Keeper | None,
) -> None:
    """Run all samples: `march(first, last)` takes steps first .. last - 1, and after it
    `check(first, last)` examines samples first .. last - 1.

    work : of a step, in freedoms that leapfrog steps in that time.
    Every stretch ends with the step of a sample: what follows it belongs to the next one.
    parts : all that changes in the run. film : takes snapshots; keeper : may save the parts after
    every stretch; None without.
    """
    chunk = FREEDOM_STEPS_AT_ONCE // (work * time.stride)
    chunk = max(1, min(chunk, time.samples // LEAST_STRETCHES))
    stops = {time.samples, *range(0, time.samples, chunk)}
    if film is not None:
        stops.update(range(1, time.samples, film.every))
        parts = (parts, film.shots)
    done = begin(keeper, film, parts)
    for first, last in pairwise(sorted({done, *(stop for stop in stops if stop > done)})):
        march(_step_after(first, time), _step_after(last, time))
        check(first, last)
        if film is not None:
            film.look(last - 1)
        if keeper is not None:
            show(keeper, last, parts)
        if progress:
            progress(last / time.samples)


def _step_after(samples: int, time: Clock) -> int:
    """Return the step behind the last of so many samples."""
    return (samples - 1) * time.stride + 1 if samples else 0
