"""A plane pulse among parallel joints in time, as the sum of harmonic waves of each layer.

In each layer waves along +n start at its first joint and waves along -n at its last one, so that
every exponential of the sum decays. Points lie at (x, z) in the axes (t, n) of the joints, and

    v(t) = sum over waves of g A e^{i omega (p x +- q z)},   stress likewise (`waves.stress`).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import in_components
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.waves import (
    ACROSS,
    KINDS,
    Kind,
    is_evanescent,
    kinds_with,
    polarisations,
    slownesses_across,
    speed_of,
    stress,
)

#: Particle velocity (m/s) as a function of times (s), along the polarisation of the wave.
Pulse = Callable[[np.ndarray], np.ndarray]
STRAIGHT = 1e-6  #: sine of the largest angle from the normal at which a wave travels along it


class Axes(NamedTuple):
    """Axes of the joints: rows t, n and, in space, b in those of the scene [d, d], n along the
    travel; slowness p along t (s/m); the kind of the incident wave, and amplitudes of all `kinds`
    that it becomes, of which its own alone is not zero."""

    rows: np.ndarray
    slowness: float
    kind: Kind
    incident: np.ndarray

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of waves that there are."""
        return kinds_with(self.kind)


class Layers(NamedTuple):
    """Amplitudes [layers, omega, kinds] along +n at each layer's first joint, along -n at its
    last; in the half-spaces both at their only joint."""

    down: np.ndarray
    up: np.ndarray


class PulseStack(NamedTuple):
    """Joints in the order in which a pulse meets them.

    depths : along n, ascending, m. layers : of omega (rad/s), for a unit incident wave at the first
    joint. at_once : real amplitudes [layers, kinds] that follow a pulse without delay; they are
    summed in time, with all its kinks, and only the smoother rest is inverted.
    rocks : of the layers; where they differ no wave may be evanescent.
    """

    axes: Axes
    depths: np.ndarray
    layers: Callable[[np.ndarray], Layers]
    at_once: Layers
    rocks: Sequence[ElasticRock]

    @property
    def slownesses(self) -> np.ndarray:
        """Slownesses across the joints of every layer, complex [layers, kinds], s/m."""
        p, kinds = self.axes.slowness, self.axes.kinds
        return np.array([slownesses_across(one, p, kinds) for one in self.rocks])

    @property
    def lead(self) -> complex:
        """Arrival time of the pulse at the first joint, s."""
        return self.slownesses[0, self.axes.kinds.index(self.axes.kind)] * self.depths[0]

    @property
    def is_evanescent(self) -> bool:
        """Whether P waves decay away from the joints."""
        return self.axes.kinds == KINDS and is_evanescent(self.rocks[0], self.axes.slowness)


def axes_of(
    rock: ElasticRock,
    kind: Kind,
    direction: np.ndarray,
    normal: np.ndarray,
    polarisation: np.ndarray | None = None,
) -> Axes:
    """Return the axes of joints of a unit normal [d] for waves that travel in a direction [d], not
    along the joints.

    polarisation : of an S wave in space [3]: the part of it that moves rock as its kind does is the
    incident amplitude.
    """
    direction = np.asarray(direction) / np.linalg.norm(direction)
    n = np.asarray(normal) * (1.0 if direction @ normal > 0 else -1.0)
    share = 1.0
    if len(n) == 2:
        rows = np.array([[-n[1], n[0]], n])
    else:
        t = direction - (direction @ n) * n
        if np.linalg.norm(t) < STRAIGHT:
            free = kind == "P" or polarisation is None
            t = np.eye(3)[np.abs(n).argmin()] if free else np.asarray(polarisation)
            t = t - (t @ n) * n
        t = t / np.linalg.norm(t)
        rows = np.array([t, n, np.cross(t, n)])
        if polarisation is not None and kind != "P":
            moved = rows[2] if kind == "SH" else (direction @ n) * t - (direction @ t) * n
            share = float(moved @ polarisation)
    slowness, kinds = direction @ rows[0] / speed_of(rock, kind), kinds_with(kind)
    return Axes(rows, float(slowness), kind, share * np.eye(len(kinds))[kinds.index(kind)])


def modes_of(stack: PulseStack) -> np.ndarray:
    """Return velocity, and stress over the first rock's Z_p, of unit waves of all kinds, along +n
    and then along -n [layers, waves, d + components], as of a `WaveMotion`."""
    axes, found = stack.axes, []
    for rock, across in zip(stack.rocks, stack.slownesses, strict=True):
        if axes.kinds == ACROSS:
            g = np.tile(axes.rows[2] + 0j, (2, 1))
        else:
            g = polarisations(rock, axes.slowness).reshape(4, 2) @ axes.rows[:2]
        along = np.full(len(g), axes.slowness)
        s = np.stack([along, np.concatenate([across, -across])], axis=-1) @ axes.rows[:2]
        tensor = stress(rock, s, g) / stack.rocks[0].p_impedance
        found.append(np.concatenate([g, in_components(tensor)], axis=1))
    return np.array(found)
