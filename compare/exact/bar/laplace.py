"""The bars of `compare.exact.bar.transfer` over time, by inversion of Laplace transforms.

By `compare.exact.inversion`, with s = -i omega. Errors and their bounds:
- A window of TAIL durations wraps later motion, reduced by the factor WRAPPED, and amplifies
  round-off as much as the exponential window amplifies the end of the record.
- The load's transform is that of its exact means over the fine steps, divided by the transform of
  such a step: sampling loses digits only at the highest frequencies.
- Frequencies end at pi/dt, tapered so that no ringing grows under the window. Smooth parts are
  unaffected; a kink's error is its change of slope times dt/(0.61 pi^2). Steps are finer than
  necessary where that is cheap. In undamped rock, kinks and jumps of the load travel to and fro in
  front of the first joint, which reflects them like a free end: this part is summed as `images`,
  and the rest, smoother by one order, is inverted.
The inversion with half of the frequencies has at least twice the error. The bound is twice the
largest difference of the two within some fine steps of each sample.
"""

from dataclasses import replace
from math import ceil
from typing import Any

import numpy as np

from jointwave.cases.histories import Late, LoadHistory, Recorded, Step
from jointwave.cases.size import require
from jointwave.compare.exact.bar.images import Front
from jointwave.compare.exact.bar.transfer import Bar, End, nodes_of, transfer
from jointwave.compare.exact.inversion import Window, taper, window_of

TAIL = 1.5
WRAPPED = 1e-10
NODE = 0.5  # place in each bin: the midpoint, as causal motion is real at omega = 0
STEPS_PER_PERIOD = 1600
STEPS_PER_DURATION = 20_000  # where the load has no period
FINER = 4  # most refinement of steps: errors of shipped scenes are below 1e-7 of their peaks
CHEAP = 12_000_000  # instants times nodes that take about half a second
MOST_TRIPS = 5000  # round trips in front of the first joint
SAFETY = 2.0  # factor on the difference of the two inversions
NEAR = 17  # fine steps within which the largest difference is taken
FLOOR = 8e-9  # error by wrapping and amplified round-off, over a quantity's peak


def bounded(
    bar: Bar,
    load: LoadHistory,
    times: np.ndarray,
    stress_y: list[float],
    velocity_y: list[float],
    period: float | None = None,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return stress (Pa), velocity (m/s) and displacement (m) [receivers, n] at `times`, and bounds
    on their root-mean-square errors [receivers].

    `times` are equally spaced from 0; `period` (s) is that of the load, if it has one. Velocity on
    an interface is the mean of both sides.
    """
    from scipy.ndimage import maximum_filter1d

    places, ahead_of = np.array([*stress_y, *velocity_y]), _front(bar, times[-1])
    dt, stride = _fine_step(times, period, len(nodes_of(bar, places)) + 4 * len(places))
    count = ceil(TAIL * stride * len(times))
    require(8.0 * count * (10 + 11 * len(places)), f"{count:,} instants of the load")
    window = window_of(0.0, dt, stride, count, WRAPPED)
    omega = window.omega(NODE)
    s, transformed = -1j * omega, _transform(load, window)
    entering = [transformed * taper(omega, share * dt) for share in (1, 2)]
    sigma, v = transfer(bar, s, places)
    sharp = [np.zeros((len(y), len(times))) for y in (stress_y, velocity_y, velocity_y)]
    if ahead_of is not None:
        front, rock = ahead_of
        shares = front.shares(places)
        ahead = shares > 0
        sigma[ahead], v[ahead] = (
            x[ahead] - shares[ahead, None] * part
            for x, part in zip((sigma, v), transfer(rock, s, places[ahead]), strict=True)
        )
        sharp = front.waves(load, times, stress_y, velocity_y)
    n, every = len(stress_y), slice(0, stride * len(times))
    found, bounds = [], []
    for part, x in zip(sharp, (sigma[:n], v[n:], v[n:] / s), strict=True):
        both = np.stack([x * one for one in entering])
        fine, rough = window.motion(both, NODE, every).real
        smooth = fine[:, ::stride]
        near = maximum_filter1d(np.abs(rough - fine), NEAR, axis=1)[:, ::stride]
        off = np.sqrt(np.mean(near**2, axis=1))
        peak = max(np.abs(part).max(initial=0.0), np.abs(smooth).max(initial=0.0))
        found.append(part + smooth)
        bounds.append(SAFETY * off + FLOOR * peak)
    return found, bounds


def _transform(load: LoadHistory, window: Window) -> np.ndarray:
    """Return the load's transform from its means over the fine steps, with jumps in closed form."""
    dt, t, s, jumps = window.step, window.times, -1j * window.omega(NODE), _jumps(load)
    edges = np.append(t, t[-1] + dt) - dt / 2
    impulse = load.impulse(edges)
    for at, jump in jumps:
        impulse = impulse - jump * np.maximum(edges - at, 0.0)
    step = np.sinh(s * dt / 2) / (s * dt / 2)
    found = window.transform(np.diff(impulse) / dt, NODE) / step
    for at, jump in jumps:
        found += jump * np.exp(-s * at) / s
    return found


def _jumps(load: LoadHistory) -> list[tuple[float, float]]:
    """Return the times (s) and heights (Pa) of a load's jumps."""
    if isinstance(load, Late):
        return [(at + load.by, jump) for at, jump in _jumps(load.history)]
    if isinstance(load, Step):
        return [(0.0, load.amplitude)]
    if isinstance(load, Recorded):
        ends = (load.time[0], load.stress[0]), (load.time[-1], -load.stress[-1])
        return [(float(at), float(jump)) for at, jump in ends if jump]
    return []


def _front(bar: Bar, duration: float) -> tuple[Front, Bar] | None:
    """Return the part of a bar in front of its first joint, in which kinks of the load travel to
    and fro, as `Front` and as a bar; None without one."""
    first, *others = bar.rocks
    if first.time_constant or first.relaxation is not None:
        return None
    z = np.sqrt(first.density * first.modulus)
    joints, _, etas = bar.interfaces
    length, far = bar.length, bar.end
    if etas.any():
        return None
    if len(joints):
        length, far = float(joints[0]), End(0.0)
    if others and others[0].y < length * (1 - 1e-9):
        behind = others[0]
        stiff = np.inf if behind.time_constant else np.sqrt(behind.density * behind.modulus)
        length, far = behind.y, End(stiff)
    if duration * z / first.density > 2 * length * MOST_TRIPS:
        return None
    near, far = (End(0.0) if end.compliance else end for end in (bar.start, far))
    names = "joint_y", "joint_compliance", "joint_time_constant"
    alone: dict[str, Any] = {"rocks": (first,), **dict.fromkeys(names, np.zeros(0))}
    rock = replace(bar, length=length, start=near, end=far, **alone)
    start, end = (
        1.0 if np.isinf(e.dashpot) else (e.dashpot - z) / (e.dashpot + z) for e in (near, far)
    )
    enters, on_end = z / (z + near.dashpot), 0.5 if length < bar.length else 1.0
    return Front(length, z / first.density, z, start, end, enters, on_end), rock


def _fine_step(times: np.ndarray, period: float | None, nodes: int) -> tuple[float, int]:
    """Return the fine step (s) and the fine steps per sample; nodes : computed at each instant."""
    interval, duration = times[1] - times[0], times[-1]
    longest = duration / STEPS_PER_DURATION
    if period is not None:
        longest = period / STEPS_PER_PERIOD
    stride = ceil(interval / longest * (1 - 1e-9))
    stride *= max(1, min(FINER, int(CHEAP / (TAIL * stride * len(times) * nodes))))
    return interval / stride, stride
