"""A long run in stretches, between which it is looked at: is it still sound, how far is it."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np

from cases.errors import UnstableError
from cases.sampling import Clock

if TYPE_CHECKING:
    from cases.snapshots import Film

BLOCK_STEPS_BETWEEN_LOOKS = 20_000_000  # some 10 ms to 1 s: often enough for a progress bar
STEPS_BETWEEN_LOOKS = 64  # at least: threads that follow one another need some to share


class Stretch(NamedTuple):
    """What has just been run: up to which time, with which step and critical step, s."""

    until: float
    dt: float
    critical: float

    def refuse_unless(self, finite: bool) -> None:
        """Raise UnstableError for a motion that is no longer finite."""
        if not finite:
            raise UnstableError(
                f"the rigid blocks are no longer finite at t = {self.until:.4g} s "
                f"(step {self.dt:.4g} s, critical {self.critical:.4g} s)"
            )


def march_with_looks(
    time: Clock,
    critical: float,
    blocks: int,
    march: Callable[[int, int], None],
    check: Callable[[Stretch], None],
    progress: Callable[[float], None] | None,
    film: Film | None = None,
) -> None:
    """Run all samples: `march(first, last)` takes samples first .. last - 1, then `check` looks.

    film : stops the run where it keeps a sample; None where it keeps none.
    """
    steps = max(STEPS_BETWEEN_LOOKS, BLOCK_STEPS_BETWEEN_LOOKS // blocks)
    stops = {time.samples, *range(0, time.samples, max(1, steps // time.stride))}
    if film is not None:
        stops.update(range(0, time.samples, film.every))
    for first, last in pairwise(sorted(stops)):
        if film is not None:
            film.look(first)
        march(first, last)
        check(Stretch(last * time.stride * time.dt, time.dt, critical))
        if progress:
            progress(last / time.samples)


def versions() -> str:
    """Return what the engine runs on, as JSON."""
    return json.dumps({"numpy": np.__version__, "numba": numba.__version__})
