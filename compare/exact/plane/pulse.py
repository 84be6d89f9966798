"""A plane pulse among parallel joints in time, as the sum of harmonic waves of each layer.

In each layer waves along +n start at its first joint and waves along -n at its last one, so that
every exponential of the sum decays. Points lie at (x, z) in the axes (t, n) of the joints, and

    v(t) = sum over waves of g A e^{i omega (p x +- q z)},   stress likewise (`waves.stress`).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.waves import (
    KINDS,
    Kind,
    is_evanescent,
    polarisations,
    slownesses_across,
    speed_of,
    stress,
)

#: Particle velocity (m/s) as a function of times (s), along the direction of travel (P) or along it
#: rotated anticlockwise by a right angle (SV).
Pulse = Callable[[np.ndarray], np.ndarray]


class Axes(NamedTuple):
    """Axes of the joints: rows t and n in x and y, n along the travel; p (s/m); incident [2]."""

    rows: np.ndarray
    slowness: float
    incident: np.ndarray


class Layers(NamedTuple):
    """Amplitudes [layers, omega, (P, SV)] along +n at each layer's first joint, along -n at its
    last; in the half-spaces both at their only joint."""

    down: np.ndarray
    up: np.ndarray


class PulseStack(NamedTuple):
    """Joints in the order in which a pulse meets them.

    depths : along n, ascending, m. layers : of omega (rad/s), for a unit incident wave at the first
    joint. at_once : real amplitudes [layers, 2] that follow a pulse without delay; they are summed
    in time, with all its kinks, and only the smoother rest is inverted.
    rocks : of the layers; where they differ no wave may be evanescent.
    """

    axes: Axes
    depths: np.ndarray
    layers: Callable[[np.ndarray], Layers]
    at_once: Layers
    rocks: Sequence[ElasticRock]

    @property
    def slownesses(self) -> np.ndarray:
        """c/a and k/b of every layer, complex [layers, 2], s/m."""
        return np.array([slownesses_across(one, self.axes.slowness) for one in self.rocks])

    @property
    def lead(self) -> complex:
        """Arrival time of the pulse at the first joint, s."""
        return self.axes.incident @ self.slownesses[0] * self.depths[0]

    @property
    def is_evanescent(self) -> bool:
        """Whether P waves decay away from the joints."""
        return is_evanescent(self.rocks[0], self.axes.slowness)


def axes_of(rock: ElasticRock, kind: Kind, direction: np.ndarray, dip: float) -> Axes:
    """Return the axes of joints of this dip (rad) for waves that travel in a direction [2], not
    along the joints."""
    direction = np.asarray(direction) / np.hypot(*direction)
    n = np.array([-np.sin(dip), np.cos(dip)])
    n = n if direction @ n > 0 else -n
    t = np.array([-n[1], n[0]])
    slowness = direction @ t / speed_of(rock, kind)
    return Axes(np.array([t, n]), float(slowness), np.eye(2)[KINDS.index(kind)])


def modes_of(stack: PulseStack) -> np.ndarray:
    """Return velocity, and stress over the first rock's Z_p, of unit waves [layers, (P+, SV+, P-,
    SV-), (x, y, xx, yy, xy)]."""
    axes, found = stack.axes, []
    for rock, across in zip(stack.rocks, stack.slownesses, strict=True):
        g = polarisations(rock, axes.slowness).reshape(4, 2)
        along = np.full(4, axes.slowness)
        s = np.stack([along, np.concatenate([across, -across])], axis=-1)
        g, s = g @ axes.rows, s @ axes.rows
        tensor = stress(rock, s, g) / stack.rocks[0].p_impedance
        found.append(np.concatenate([g, tensor[:, [0, 1, 0], [0, 1, 1]]], axis=1))
    return np.array(found)
