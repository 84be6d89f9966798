"""The time loop: a run in chunks of samples, with a check, checkpoint and report after each.

Engines write no files and handle no signals. Between chunks they pass their state to a keeper, as
nested tuples of arrays (`results.arrays`).
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, Protocol

from jointwave.cases.errors import StoppedError


class Checkpointer(Protocol):
    """Saves and restores the state of a run; done : samples of an earlier run of it, or 0."""

    done: int

    def restore(self, parts: Any) -> None:
        """Copy the state after `done` samples into `parts`."""

    def look(self, samples: int, parts: Any) -> None:
        """Save the parts if due, or raise InterruptedRun with the number of samples."""


def run_in_chunks(
    samples: int,
    chunk: int,
    march: Callable[[int, int], None],
    result: Callable[[int], Any],
    parts: Any,
    progress: Callable[[float], None] | None = None,
    recorder: Any = None,
    keeper: Checkpointer | None = None,
) -> Any:
    """Take all samples of a run in chunks of `chunk`, and return its result.

    march : takes samples first .. last - 1; raises StoppedError if the run exceeds its bounds.
    result : returns the result of so many samples; the error gets that of the valid ones. parts :
    the state of the run. recorder : `results.snapshots.SnapshotRecorder`, or None; snapshots are
    taken at the start of a chunk. keeper : saves checkpoints after chunks, or None.
    """
    stops, done = {samples, *range(0, samples, max(1, chunk))}, 0
    if recorder is not None:
        stops.update(range(0, samples, recorder.every))
        parts = (parts, recorder.frames)
    if keeper is not None and keeper.done:
        done = keeper.done
        if recorder is not None:
            recorder.allocate(done)
        keeper.restore(parts)
    try:
        for first, last in pairwise(sorted({done, *(stop for stop in stops if stop > done)})):
            march(first, last)
            if keeper is not None:
                keeper.look(last, parts)
            if progress:
                progress(last / samples)
    except StoppedError as error:
        error.result = result(error.samples)
        raise
    return result(samples)
