"""The cost of a run before it is made: its steps, its size, its seconds, its memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from cases.schema.scene import Scene
from compare.engines import solver
from compare.experiments.cost import timings


class Forecast(NamedTuple):
    """A run that is not made.

    steps : of time, exactly; 0 of exact solutions. size : blocks or freedoms of the rock, in words.
    seconds : of stepping, at the rate last measured here; None where none was. bytes : of memory,
        as the run itself would estimate it before it begins; of exact solutions their waveforms,
        which is the least that they take.
    """

    variant: str
    engine: str
    steps: int
    size: str
    scheme: str
    seconds: float | None
    bytes: float


def forecast(scene: Scene, name: str) -> Forecast:
    """Return what a run of an engine or exact solution would take.

    Raises SceneError where it cannot be made, as the run would.
    """
    one = solver(name)
    run = one.prepare(scene)
    seconds = timings.stepping(name, scene, run.settings, run.steps, run.freedoms)
    size = f"{one.units(scene, run.freedoms):,} {one.unit}" if run.steps else "-"
    return Forecast(scene.name, name, run.steps, size, run.scheme, seconds, run.bytes)


def seconds_of(found: Iterable[Forecast]) -> tuple[float, int]:
    """Return the seconds of all that were ever timed here, and how many were not."""
    known = [one.seconds for one in found]
    return sum(s for s in known if s is not None), known.count(None)
