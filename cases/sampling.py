"""Sampling of a run: sample times, a time step that divides the interval, and interpolation."""

from math import ceil
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period

MOST_STEPS = 1e12  # some five hours for a hundred rigid blocks; more is taken for a mistake


class Clock(NamedTuple):
    """A time step that divides the sampling interval.

    dt : s; stride : steps per sample; samples : number of samples, the first at t = 0.
    """

    dt: float
    stride: int
    samples: int

    @property
    def steps(self) -> int:
        """Number of steps from the first to the last sample."""
        return self.stride * (self.samples - 1)

    @property
    def times(self) -> np.ndarray:
        """Sample times [samples], s."""
        return self.dt * self.stride * np.arange(self.samples)


def sample_times(scene: AnyScene) -> np.ndarray:
    """Return the sample times of a scene [n], s."""
    count = int(scene.time.duration / scene.interval + 1e-9) + 1
    return scene.interval * np.arange(count)


def resolved_period(scene: AnyScene) -> float:
    """Return the period that elements and steps resolve, s: the shortest of the scene's pulses, or
    a tenth of its duration."""
    return shortest_period(scene.pulses) or scene.time.duration / 10


def clock(
    scene: AnyScene, critical: float, fraction: float, allow_unstable: bool, key: str
) -> Clock:
    """Return the largest time step up to `fraction * critical` (s) that divides the interval.

    A step above the critical one is rounded to the nearest divisor instead, if it is allowed; else
    SceneError is raised with both numbers.
    """
    wanted, own = fraction * critical, f"numerics.{key}.step_fraction"
    if fraction > 1 and not allow_unstable:
        allowed = (
            f"gives a step of {wanted:.4g} s above the critical step {critical:.4g} s; "
            f"at most 1, unless numerics.{key}.allow_unstable = true"
        )
        raise SceneError(scene.where, own, fraction, allowed)
    ratio = scene.interval / wanted
    if fraction > 1 and ratio < 1:
        allowed = f"must be at least the step {wanted:.4g} s of {own}"
        raise SceneError(scene.where, "record.interval", scene.interval, allowed)
    stride = max(1, ceil(ratio * (1 - 1e-12)) if fraction <= 1 else round(ratio))
    found = Clock(scene.interval / stride, stride, len(sample_times(scene)))
    if found.steps > MOST_STEPS:
        allowed = f"gives {found.steps:.3g} steps of {found.dt:.4g} s; at most {MOST_STEPS:.0e}"
        raise SceneError(scene.where, own, fraction, allowed)
    return found


class Interpolation(NamedTuple):
    """Linear interpolation from nodes to places: value = (1 - weight) x[left] + weight x[right]."""

    left: np.ndarray
    right: np.ndarray
    weight: np.ndarray


def interpolation(nodes: np.ndarray, places: list[float]) -> Interpolation:
    """Return the interpolation from sorted `nodes` [n], m, to `places`, m; constant outside."""
    at = np.asarray(places, dtype=float)
    right = np.clip(np.searchsorted(nodes, at - 1e-9 * nodes[-1]), 1, max(1, len(nodes) - 1))
    left = right - 1
    right = np.minimum(right, len(nodes) - 1)
    span = np.where(right > left, nodes[right] - nodes[left], 1.0)
    weight = np.clip((at - nodes[left]) / span, 0.0, 1.0)
    snapped = np.where(np.abs(weight - np.round(weight)) < 1e-9, np.round(weight), weight)
    return Interpolation(left, right, snapped)
