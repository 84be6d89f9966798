"""Checkpoints of a run as engines see them: the state is saved or restored, or the run is stopped.

Engines write no files and handle no signals. They pass their state to a keeper, as nested tuples
of arrays (`results.arrays`), between intervals of steps.
"""

from __future__ import annotations

from typing import Any, Protocol

from cases.errors import InterruptedRun


class Film(Protocol):
    """Snapshots of every `every`-th sample; those of an earlier part of the run may be present.

    shots : the recorded arrays of each.
    """

    every: int
    shots: list[Any]

    def expect(self, samples: int) -> None:
        """Count the snapshots of so many samples as taken."""


class Keeper(Protocol):
    """Saves and restores the state of one run.

    done : number of samples of an earlier run of the same scene; 0 for a new run.
    """

    done: int

    def restore(self, parts: Any) -> None:
        """Copy the state after `done` samples into `parts`."""

    def look(self, samples: int, parts: Any) -> None:
        """Save the parts after so many samples, or raise InterruptedRun."""


def begin(keeper: Keeper | None, film: Film | None, parts: Any) -> int:
    """Restore the parts of a run, and return how many samples are done."""
    if keeper is None or not keeper.done:
        return 0
    if film is not None:
        film.expect(keeper.done)
    keeper.restore(parts)
    return keeper.done


def show(keeper: Keeper, samples: int, parts: Any) -> None:
    """Pass a run to its keeper, and record its number of samples if the keeper stops it."""
    try:
        keeper.look(samples, parts)
    except InterruptedRun as error:
        error.samples = samples
        raise
