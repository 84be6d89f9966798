"""A long run in stretches, between which it is looked at: is it still sound, how far is it."""

import json
from collections.abc import Callable
from typing import NamedTuple

import numba
import numpy as np

from cases.errors import UnstableError
from cases.sampling import Clock

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
) -> None:
    """Run all samples: `march(first, last)` takes samples first .. last - 1, then `check` looks."""
    steps = max(STEPS_BETWEEN_LOOKS, BLOCK_STEPS_BETWEEN_LOOKS // blocks)
    chunk = max(1, steps // time.stride)
    for first in range(0, time.samples, chunk):
        last = min(first + chunk, time.samples)
        march(first, last)
        check(Stretch(last * time.stride * time.dt, time.dt, critical))
        if progress:
            progress(last / time.samples)


def versions() -> str:
    """Return what the engine runs on, as JSON."""
    return json.dumps({"numpy": np.__version__, "numba": numba.__version__})
