"""The one-line error of a stopped run: where, when, why, and what to change."""

from __future__ import annotations

from typing import NamedTuple

from jointwave.cases.errors import StoppedError
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

HUGE = 1e100  # an amplitude whose square overflows


class Divergence(NamedTuple):
    """A finding of the divergence monitor.

    engine : in words. key : of the scene, that decides the step. step : at which a bound was
    exceeded, after the last `sound` one. energy : whether the ledger exceeded it, not a speed.
    y : of the fastest point, m; in the plane x and y.
    """

    engine: str
    key: str
    step: int
    sound: int
    energy: bool
    y: float | tuple[float, float]


def stopped(
    scene: Scene | RockMass, time: Clock, critical: float, seen: Divergence
) -> StoppedError:
    """Return the error of a run that exceeds its bounds, with the valid samples; critical in s."""
    name = f"{scene.where}, {scene.name}" if scene.name else scene.where
    what = "gained energy" if seen.energy else "diverged"
    error = StoppedError(
        f"{name}: {seen.engine} {what} at t = {seen.step * time.dt:.6g} s, step {seen.step} of "
        f"{time.dt:.4g} s, fastest at {_place(seen)} m: {_cause(scene, time, critical, seen)}"
    )
    error.samples = max(0, seen.sound) // time.stride + 1
    return error


def _place(seen: Divergence) -> str:
    if isinstance(seen.y, tuple):
        return "[" + ", ".join(f"{x:.6g}" for x in seen.y) + "]"
    return f"y = {seen.y:.6g}"


def _cause(scene: Scene | RockMass, time: Clock, critical: float, seen: Divergence) -> str:
    if time.dt > 0.9999 * critical:
        return (
            f"the step is {time.dt / critical:.4g} times the critical step {critical:.4g} s; "
            f"set {seen.key} to at most 0.9"
        )
    if any(abs(one.amplitude or 0.0) > HUGE for one in scene.pulses):
        return "numbers overflow; use a smaller load.amplitude"
    return (
        "joints open, close, stiffen or slide within a step, or the scene exceeds the limits of "
        f"the scheme; {'halve' if seen.key.endswith('fraction') else 'double'} {seen.key}"
    )
