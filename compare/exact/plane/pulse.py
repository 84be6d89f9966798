"""A plane pulse among parallel joints in time, as the sum of harmonic waves of each layer.

In each layer waves along +n start at its first joint and waves along -n at its last one, so that
every exponential of the sum decays. Points lie at (x, z) in the axes (t, n) of the joints, and

    v(t) = sum over waves of g A e^{i omega (p x +- q z)},   stress likewise (`waves.stress`).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.inversion import inverse
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


class Fields(NamedTuple):
    """Motion at points, arrays [points, components, times], and bounds [points, components] on its
    root-mean-square error: velocity (x, y) in m/s, stress (xx, yy, xy) in Pa, tension positive.
    """

    velocity: np.ndarray
    stress: np.ndarray
    velocity_error: np.ndarray
    stress_error: np.ndarray


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


def pulse_fields(pulse: Pulse, stack: PulseStack, points: np.ndarray, times: np.ndarray) -> Fields:
    """Return particle velocity and stress in front of, between and behind joints.

    pulse : at the origin, taken as zero before the first of the times. points : [m, 2], m; one on a
    joint belongs to the side from which the pulse comes. times : equally spaced, s.
    """
    axes, depths, q = stack.axes, stack.depths, stack.axes.incident @ stack.slownesses[0]
    t, places = np.asarray(times, dtype=float), np.atleast_2d(points) @ axes.rows.T
    waves = [_waves(place, stack) for place in places]
    modes = modes_of(stack)[[layer for layer, _ in waves]]
    sharp = np.concatenate(stack.at_once, axis=-1)

    def transfer(omega: np.ndarray) -> np.ndarray:
        amplitudes = np.concatenate(stack.layers(omega), axis=-1) - sharp[:, None]
        found = [_delayed(amplitudes[layer], omega, delays) for layer, delays in waves]
        return np.einsum("mkw,mwc->mck", np.array(found), modes)

    earliest = axes.slowness * places[:, 0] + q.real * np.minimum(places[:, 1], depths[0])
    found, error = inverse(transfer, pulse, t, earliest.min(), not stack.is_evanescent)
    for each, mode, (layer, delays) in zip(found, modes, waves, strict=True):
        at = t - delays.real[:, None]
        passed = np.where(at < t[0], 0, pulse(at))  # zero before the first time
        each += mode.real.T @ (sharp[layer][:, None] * passed)
    unit = float(stack.rocks[0].p_impedance)
    return Fields(found[:, :2], unit * found[:, 2:], error[:, :2], unit * error[:, 2:])


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


def _waves(place: np.ndarray, stack: PulseStack) -> tuple[int, np.ndarray]:
    """Return the layer of a place (t, n) and the complex delays (s) of [P+, SV+, P-, SV-] there
    from the points at which their amplitudes are given."""
    (x, z), depths = place, stack.depths
    layer = int(np.searchsorted(depths, z))
    first, last = depths[max(layer - 1, 0)], depths[min(layer, len(depths) - 1)]
    across = stack.slownesses[layer]
    late = np.concatenate([across * (z - first), across * (last - z)])
    return layer, late + stack.axes.slowness * x + stack.lead


def _delayed(amplitudes: np.ndarray, omega: np.ndarray, delays: np.ndarray) -> np.ndarray:
    """Return amplitudes [omega, wave] delayed by `delays` (s)."""
    phases = 1j * omega[:, None] * delays
    return amplitudes * np.exp(np.where(amplitudes == 0, 0, phases))
