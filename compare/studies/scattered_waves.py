"""The amplitudes of the plane waves in front of and behind joints, from the motion at points.

At one frequency the motion of each half-space is the sum of plane waves of one slowness p along the
joints (`compare.exact.plane.waves`): in front of them the incident wave and both reflected ones,
behind them both transmitted ones. With factor e^{-i omega t} and the place (x, z) from the joints,

    V(x, z) = sum of A g e^{i omega (p x +- q z)},   V = int v e^{i omega t} dt

is a linear system for the amplitudes A, two equations a point, solved by least squares. The speeds
are those of the intact rock. V is the trapezium rule's sum, exact for pulses that are over within
the record and have nothing above half its sampling frequency.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.pulse import Axes
from jointwave.compare.exact.plane.waves import polarisations, slownesses_across


class Scattered(NamedTuple):
    """Moduli of reflected and transmitted P and SV waves over the incident one, amplitudes of
    particle velocity; residual : part of the motion not explained by such waves, relative."""

    R_p: float
    R_s: float
    T_p: float
    T_s: float
    residual: float


def scattered(
    rock: ElasticRock,
    axes: Axes,
    places: np.ndarray,
    velocity: np.ndarray,
    interval: float,
    omega: float,
    half: float = 0.0,
) -> Scattered:
    """Return the waves scattered by joints about the origin, at the first and the last of them.

    axes : of the joints for this wave. places : [m, 2], m, on both sides. velocity :
    [m, n, (x, y)], m/s, every `interval` (s). omega : rad/s.
    half : half the distance from the first joint to the last, m, for the decay of evanescent waves.
    """
    n = velocity.shape[1]
    spectrum = np.exp(1j * omega * interval * np.arange(n)) @ velocity * interval
    along, across = places @ axes.rows.T, slownesses_across(rock, axes.slowness)
    modes = polarisations(rock, axes.slowness).reshape(4, 2) @ axes.rows
    q = np.concatenate([across, -across])
    incident = int(np.argmax(axes.incident))
    found = np.zeros(4, dtype=complex)
    left, total = 0.0, 0.0
    came = 1.0 + 0j
    for front, waves in ((True, [incident, 2, 3]), (False, [0, 1])):
        here = (along[:, 1] < 0) == front
        x, z = along[here].T
        z = z + half if front else z - half
        phases = np.exp(1j * omega * (axes.slowness * x + np.outer(q[waves], z)))
        matrix = np.einsum("wm,wc->mcw", phases, modes[waves]).reshape(-1, len(waves))
        motion = spectrum[here].ravel()
        amplitudes, *_ = np.linalg.lstsq(matrix, motion, rcond=None)
        left += float(np.linalg.norm(motion - matrix @ amplitudes) ** 2)
        total += float(np.linalg.norm(motion) ** 2)
        if front:
            came = amplitudes[0]
            found[:2] = amplitudes[1:]
        else:
            found[2:] = amplitudes
    R_p, R_s, T_p, T_s = np.abs(found / came).tolist()
    return Scattered(R_p, R_s, T_p, T_s, float(np.sqrt(left / total)))
