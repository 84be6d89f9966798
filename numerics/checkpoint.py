"""Who watches over a run from outside: keeps what it has got to, brings it back, or stops it.

Engines write no files and know no signals. They show a keeper all that changes in them, as nested
tuples of arrays (`results.arrays`), wherever they look at themselves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from cases.errors import InterruptedRun

if TYPE_CHECKING:
    from results.snapshots import Film


class Keeper(Protocol):
    """Who watches over one run.

    done : how many samples an earlier run of the same scene got to; 0 where this one is the first.
    """

    done: int

    def restore(self, parts: Any) -> None:
        """Copy into `parts` what they were when `done` samples were done."""

    def look(self, samples: int, parts: Any) -> None:
        """See the run where so many samples are done: keep its parts, or raise InterruptedRun."""


def begin(keeper: Keeper | None, film: Film | None, parts: Any) -> int:
    """Return how many samples are done before a run starts, its parts brought to what they were."""
    if keeper is None or not keeper.done:
        return 0
    if film is not None:
        film.expect(keeper.done)
    keeper.restore(parts)
    return keeper.done


def show(keeper: Keeper, samples: int, parts: Any) -> None:
    """Let a keeper see a run, and say how far it had got where the keeper stops it."""
    try:
        keeper.look(samples, parts)
    except InterruptedRun as error:
        error.samples = samples
        raise
