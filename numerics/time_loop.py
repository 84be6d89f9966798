"""The time loop: a run in intervals, after each of which it is checked, saved and reported.

Engines write no files and handle no signals. They pass their state to a keeper, as nested tuples
of arrays (`results.arrays`), between intervals of steps.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, Protocol

from jointwave.cases.errors import InterruptedRun


class SnapshotRecorder(Protocol):
    """Snapshots of every `every`-th sample; those of an earlier part of the run may be present.

    frames : the recorded arrays of each.
    """

    every: int
    frames: list[Any]

    def allocate(self, samples: int) -> None:
        """Count the snapshots of so many samples as taken."""


class Checkpointer(Protocol):
    """Saves and restores the state of one run.

    done : number of samples of an earlier run of the same scene; 0 for a new run.
    """

    done: int

    def restore(self, parts: Any) -> None:
        """Copy the state after `done` samples into `parts`."""

    def look(self, samples: int, parts: Any) -> None:
        """Save the parts after so many samples, or raise InterruptedRun."""


def run_in_chunks(
    samples: int,
    chunk: int,
    march: Callable[[int, int], None],
    parts: Any,
    progress: Callable[[float], None] | None = None,
    recorder: SnapshotRecorder | None = None,
    keeper: Checkpointer | None = None,
    snapshot_at: int = 0,
) -> None:
    """Take all samples of a run in intervals of `chunk`; `march(first, last)` takes samples
    first .. last - 1, and raises an error if the run exceeds its bounds.

    parts : the state of the run. keeper : may save it after every interval; None without.
    recorder : snapshots at ends of intervals, of the sample before (`snapshot_at` 1) or after
    (`snapshot_at` 0); None without.
    """
    stops, done = {samples, *range(0, samples, max(1, chunk))}, 0
    if recorder is not None:
        stops.update(range(snapshot_at, samples, recorder.every))
        parts = (parts, recorder.frames)
    if keeper is not None and keeper.done:
        done = keeper.done
        if recorder is not None:
            recorder.allocate(done)
        keeper.restore(parts)
    for first, last in pairwise(sorted({done, *(stop for stop in stops if stop > done)})):
        march(first, last)
        if keeper is not None:
            try:
                keeper.look(last, parts)
            except InterruptedRun as error:
                error.samples = last
                raise
        if progress:
            progress(last / samples)
