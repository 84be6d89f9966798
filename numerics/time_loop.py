"""The time loop: a run in stretches, after each of which it is checked, saved and reported."""

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
    """Take all samples of a run, `chunk` at once; `march(first, last)` takes samples first ..
    last - 1, and raises an error where the run is not sound.

    parts : all that changes in the run. keeper : may save them after every stretch; None without.
    film : snapshots, at ends of stretches: of the sample before them where `snapshot_at` is 1, of
    the sample after them where it is 0; None without.
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
