"""A plane pulse in parallel joints, at many places at once.

Each layer contains plane waves to and fro (`parallel_joints`). A travelling wave is the same pulse
throughout the layer, only delayed: its amplitude is inverted once and read at each place by a
Lagrange polynomial through 2 HALF samples. An evanescent wave decays with the depth d as e^{i omega
q d}: it is inverted at the depths of the places or, if there are many, at Chebyshev points, between
which it is interpolated in d (Trefethen, Approximation Theory and Approximation Practice, 2013).
The part that follows a pulse without delay is summed in time, with all its kinks.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import prod
from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import WaveMotion
from jointwave.compare.exact.inversion import FINE, QUICK, ROUGH, STEPS, Accuracy, inverse
from jointwave.compare.exact.plane.parallel_joints import PulseStack

#: Particle velocity (m/s) as a function of times (s), along the polarisation of the wave.
Pulse = Callable[[np.ndarray], np.ndarray]
HALF = 4  # samples on each side of a time that is interpolated
NODES = range(-HALF + 1, HALF + 1)  # these samples, relative to the one before the time
MOST_NODES = 40  # depths of an evanescent wave in a layer, including SPARE ones
SPARE = 8
NEGLIGIBLE = 1e-10  # error of an evanescent wave, relative
FAINT = 1e-8  # part of a pulse's spectrum that is neglected
AT_ONCE = 200  # amplitudes inverted together
SAFETY = 3.0  # factor on the difference of the two inversions
FLOOR = 2e-10  # round-off, over the largest motion
TOGETHER = 32  # places at which an evanescent wave is interpolated together


@dataclass(frozen=True)
class LayerWave:
    """One wave of one layer at the places where it is evaluated.

    layer : counted along n. wave : index among P+, SV+, P-, SV- or SH+, SH-. members : the places
    [k]. delays : of the pulse there [k], s. depths : at which an evanescent wave is inverted [d],
    m; shares : their weights [k, d] at the places; both None for a travelling wave.
    """

    layer: int
    wave: int
    members: np.ndarray
    delays: np.ndarray
    depths: np.ndarray | None = None
    shares: np.ndarray | None = None


class Fields(NamedTuple):
    """Velocity and stress of a `WaveMotion`, and bounds [points, components] on their rms error."""

    velocity: np.ndarray
    stress: np.ndarray
    velocity_error: np.ndarray
    stress_error: np.ndarray


def fields(pulse: Pulse, stack: PulseStack, points: np.ndarray, times: np.ndarray) -> Fields:
    """Return particle velocity and stress in front of, between and behind joints, with bounds from
    the difference of two inversions and from round-off. pulse, points, times : see `motion`."""
    found, rough = (motion(pulse, stack, points, times, how) for how in (FINE, ROUGH))
    peak, errors = np.abs(pulse(np.asarray(times))).max(), []
    for one, other, unit in zip(found, rough, (1.0, stack.rocks[0].p_impedance), strict=True):
        off = SAFETY * np.sqrt(np.mean((one - other) ** 2, axis=-1))
        errors.append(off + FLOOR * max(np.abs(one).max(initial=0.0), peak * float(unit)))
    return Fields(*found, *errors)


def motion(
    pulse: Pulse, stack: PulseStack, points: np.ndarray, times: np.ndarray, how: Accuracy = QUICK
) -> WaveMotion:
    """Return the motion at points and times.

    pulse : at the origin, zero before 0 s. points : [m, d], m; a point on a joint counts as on the
    side from which the pulse comes. times : equally spaced, s.
    """
    t, places = np.asarray(times, dtype=float), np.atleast_2d(points) @ stack.axes.rows.T
    modes = stack.modes
    highest = _highest(pulse, t) if stack.is_evanescent else 0.0
    waves = list(_waves_of(stack, places, highest))
    fine, stride = _fine_times(stack, waves, t)
    sharp = np.concatenate(stack.at_once, axis=-1)
    found = np.zeros((len(places), modes.shape[2], len(t)))
    amplitudes = _amplitudes(pulse, stack, waves, fine, how)
    for one, rows in zip(waves, amplitudes, strict=True):
        mode, share = modes[one.layer, one.wave][:, None], sharp[one.layer, one.wave]
        for k, (place, late) in enumerate(zip(one.members, one.delays, strict=True)):
            offset = (t[0] - late - fine[0]) / (fine[1] - fine[0])
            if one.shares is None:
                found[place] += mode.real * _read(rows[0].real, offset, stride, len(t))
                if share:
                    found[place] += share * mode.real * pulse(t - late)
            else:
                if k % TOGETHER == 0:
                    near = one.shares[k : k + TOGETHER] @ rows
                part = _read(near[k % TOGETHER], offset, stride, len(t))
                found[place] += mode.real * part.real - mode.imag * part.imag
    dim = places.shape[1]
    return WaveMotion(found[:, :dim], float(stack.rocks[0].p_impedance) * found[:, dim:])


def _highest(pulse: Pulse, t: np.ndarray) -> float:
    """Return the frequency above which a pulse's spectrum is below FAINT of its peak, rad/s."""
    step = (t[-1] - min(t[0], 0.0)) / STEPS
    spectrum = np.abs(np.fft.rfft(pulse(step * np.arange(STEPS))))
    last = int(np.flatnonzero(spectrum >= FAINT * spectrum.max())[-1])
    return 2 * np.pi * last / (STEPS * step)


def _waves_of(stack: PulseStack, places: np.ndarray, highest: float) -> Iterator[LayerWave]:
    """Yield the waves of all layers that contain places (t, n, b) [m, d]."""
    axes, depths, evanescent = stack.axes, stack.depths, stack.is_evanescent
    lead, kinds = stack.lead.real, len(axes.kinds)
    layers = np.searchsorted(depths, places[:, 1])
    for layer in np.unique(layers):
        members, across = np.flatnonzero(layers == layer), stack.slownesses[layer]
        x, z = places[members, :2].T
        there = z - depths[max(layer - 1, 0)], depths[min(layer, len(depths) - 1)] - z
        for wave in range(2 * kinds):
            kind, back = wave % kinds, wave // kinds
            comes = layer < len(depths) if back else layer > 0 or axes.incident[kind]
            if not comes:
                continue
            late, way = lead + axes.slowness * x, there[back]
            if evanescent and kind == 0:
                yield LayerWave(
                    int(layer), wave, members, late, *_depths(way, highest * across[0].imag)
                )
            else:
                yield LayerWave(int(layer), wave, members, late + across[kind].real * way)


def _depths(way: np.ndarray, decay: float) -> tuple[np.ndarray, np.ndarray]:
    """Return depths [d] that resolve a decay of e^{-decay d} or slower, and their weights [k, d] at
    `way`. The Chebyshev coefficients of e^{-s x}, 0 to 1, fall as e^{-k^2 / s}."""
    found, which = np.unique(np.round(way, 9), return_inverse=True)
    wanted = SPARE + np.sqrt(decay * (found[-1] - found[0]) * np.log(1 / NEGLIGIBLE))
    count = int(min(np.ceil(wanted), MOST_NODES))
    if len(found) <= count:
        return found, np.eye(len(found))[which]
    low, high = found[0], found[-1]
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    to_values = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, count - 1))
    at = np.polynomial.chebyshev.chebvander(2 * (way - low) / (high - low) - 1, count - 1)
    return low + (high - low) * (nodes + 1) / 2, at @ to_values


def _fine_times(stack: PulseStack, waves: list[LayerWave], t: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the times of amplitudes, s, and the number of fine steps per step of `t`."""
    late = np.concatenate([one.delays for one in waves])
    causal = not stack.is_evanescent
    start, dt = 0.0 if causal else min(0.0, t[0] - late.max()), t[1] - t[0]
    end = max(t[-1] - late.min(), dt)
    stride = int(np.ceil(STEPS * dt / (end - start)))
    count = int(np.ceil((end - start) / dt * stride)) + 2 * HALF
    return start + dt / stride * np.arange(count), stride


def _amplitudes(
    pulse: Pulse, stack: PulseStack, waves: list[LayerWave], fine: np.ndarray, how: Accuracy
) -> Iterator[np.ndarray]:
    """Yield each wave's complex amplitude without the undelayed part, [1, samples], or [d, samples]
    at the depths of an evanescent wave; the motion is its real part."""
    q = stack.slownesses[0, 0]  # of P; all rocks are equal if it is evanescent
    sharp = np.concatenate(stack.at_once, axis=-1)
    causal = not stack.is_evanescent
    rows = [(one, d) for one in waves for d in (one.depths if one.depths is not None else [0.0])]

    def inverted(some: list[tuple[LayerWave, float]]) -> np.ndarray:
        def transfer(omega: np.ndarray) -> np.ndarray:
            found = np.concatenate(stack.layers(omega), axis=-1) - sharp[:, None]
            # numpy multiplies the tail of a strided array by other instructions, which differ in
            # the last digit.
            found = np.ascontiguousarray(np.moveaxis(found, -1, 1))
            decay = [np.exp(1j * omega * q * d) if d else 1.0 for _, d in some]
            return np.array(
                [
                    found[one.layer, one.wave] * less
                    for (one, _), less in zip(some, decay, strict=True)
                ]
            )

        return inverse(transfer, pulse, fine, causal, how)

    parts = (inverted(rows[k : k + AT_ONCE]) for k in range(0, len(rows), AT_ONCE))
    each = (row for part in parts for row in part)
    for one in waves:
        count = 1 if one.depths is None else len(one.depths)
        yield np.array([next(each) for _ in range(count)])


def _read(series: np.ndarray, offset: float, stride: int, count: int) -> np.ndarray:
    """Return a series at offset + k stride, k = 0 .. count - 1; zero before it begins."""
    first = int(np.floor(offset))
    x = offset - first
    weights = np.array([prod([(x - m) / (k - m) for m in NODES if m != k]) for k in NODES])
    low, high = first + NODES[0], first + NODES[-1] + stride * (count - 1) + 1
    window = series[max(low, 0) : max(high, 0)]
    if len(window) < high - low:
        before = min(max(-low, 0), high - low)
        known, window = window, np.zeros(high - low, dtype=series.dtype)
        window[before : before + len(known)] = known
    return sum(w * window[k : k + stride * (count - 1) + 1 : stride] for k, w in enumerate(weights))
