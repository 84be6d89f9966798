"""Checkpoints of a run, seen from an engine: its state is saved, restored, or the run is stopped.

Engines write no files and know no signals. They hand all that changes in them to a keeper, as
nested tuples of arrays (`results.arrays`), between stretches of steps.
"""

from __future__ import annotations

from typing import Any, Protocol

from cases.errors import InterruptedRun


class Film(Protocol):
    """Snapshots of every `every`-th sample, of which those of an earlier part may be there already.

    shots : what is kept of each.
    """

    every: int
    shots: list[Any]

    def expect(self, samples: int) -> None:
        """Take the snapshots of so many samples for taken."""


class Keeper(Protocol):
    """Saves and restores the state of one run.

    done : how many samples an earlier run of the same scene got to; 0 where this one is the first.
    """

    done: int

    def restore(self, parts: Any) -> None:
        """Copy into `parts` what they were when `done` samples were done."""

    def look(self, samples: int, parts: Any) -> None:
        """Save the parts where so many samples are done, or raise InterruptedRun."""


def begin(keeper: Keeper | None, film: Film | None, parts: Any) -> int:
    """Return how many samples are done before a run starts, its parts brought to what they were."""
    if keeper is None or not keeper.done:
        return 0
    if film is not None:
        film.expect(keeper.done)
    keeper.restore(parts)
    return keeper.done


def show(keeper: Keeper, samples: int, parts: Any) -> None:
    """Hand a run to its keeper, and note how many samples it has where the keeper stops it."""
    try:
        keeper.look(samples, parts)
    except InterruptedRun as error:
        error.samples = samples
        raise
