"""The time loop: a run in intervals, after each of which it is checked, saved and reported."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from numerics.checkpoint import Film, Keeper, begin, show


def run_in_stretches(
    samples: int,
    chunk: int,
    march: Callable[[int, int], None],
    parts: Any,
    progress: Callable[[float], None] | None = None,
    film: Film | None = None,
    keeper: Keeper | None = None,
    snapshot_at: int = 0,
) -> None:
    """Take all samples of a run in intervals of `chunk`; `march(first, last)` takes samples
    first .. last - 1, and raises an error if the run exceeds its bounds.

    parts : the state of the run. keeper : may save it after every interval; None without.
    film : snapshots at ends of intervals, of the sample before (`snapshot_at` 1) or after
    (`snapshot_at` 0); None without.
    """
    stops = {samples, *range(0, samples, max(1, chunk))}
    if film is not None:
        stops.update(range(snapshot_at, samples, film.every))
        parts = (parts, film.shots)
    done = begin(keeper, film, parts)
    for first, last in pairwise(sorted({done, *(stop for stop in stops if stop > done)})):
        march(first, last)
        if keeper is not None:
            show(keeper, last, parts)
        if progress:
            progress(last / samples)
