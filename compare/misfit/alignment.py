"""Alignment of external curves with solutions on common times.

Only the common time span is compared, at the times of the waveform with fewer samples in it (the
curve's own, if equal); the other is interpolated linearly, with an error of at most h^2 / 8 max
|s''| for its sampling interval h. No filter is applied: straight lines neither ring nor spread at
the kinks of a load, unlike band-limited interpolation. Clocks are shifted only on request, by the
same amount for all curves of a file, by cross-correlation with the solution that then fits best.
Amplitudes are never scaled.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import nan
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.sampling import sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.misfit.external import LEAST_SAMPLES, Curves
from jointwave.compare.misfit.metrics import Distance, distance, relative_l2, static_state
from jointwave.compare.misfit.places import Place

MOST_SAMPLES = 4_000_000  # of a curve whose clock is shifted, at the scene's interval
INSTANT = 1e-12  # s, resolution of times, also in tables
UNEVEN = 0.01  # rounding error of printed times, over the sampling interval

Results = dict[str, xr.Dataset]


class Shift(NamedTuple):
    """The shift added to a curve's times, s, the solution that it then fits, and how well.

    onto : "" without correlation: no shift. correlation : normalised, 1 for equal shapes.
    """

    seconds: float = 0.0
    onto: str = ""
    correlation: float = nan


@dataclass(frozen=True)
class AlignedCurve:
    """A file's curves compared with the solutions of one scene.

    curves : at their own samples, on the shifted clock. shift : None unless requested. time : [n]
    s, common times of the comparison. own_times : whether these are the curves' own. outside : part
    of the curves' duration outside the overlap.
    """

    curves: Curves
    shift: Shift | None
    time: np.ndarray
    own_times: bool
    outside: float

    def series(self, place: Place) -> pd.Series:
        """Return the curve at a place in SI over time in s, at its own samples in the overlap."""
        own, values = self.curves.time, self.curves.waveforms[place]
        inside = (own >= self.time[0] - INSTANT) & (own <= self.time[-1] + INSTANT)
        found = pd.Series(values[inside], np.round(own[inside], 12))
        return found[~found.index.duplicated()]


def align_curve(curves: Curves, scene: AnyScene, results: Results, align: bool) -> AlignedCurve:
    """Return a file's curves aligned with all results of a scene; `align` shifts their clock.
    Raises SceneError if curve and scene share fewer than three samples."""
    shift = None
    if align:  # onto the solution that then fits best
        if (curves.time[-1] - curves.time[0]) / scene.interval > MOST_SAMPLES:
            allowed = f"must last at most {MOST_SAMPLES:,} intervals of the scene to be aligned"
            raise SceneError(curves.file, "time", f"{curves.time[-1]:.6g} s", allowed)
        every = (_shift_onto(name, result, curves, scene) for name, result in results.items())
        fitting = [one for one in every if one.onto]
        shift = max(fitting, key=lambda one: one.correlation, default=Shift())
    moved = replace(curves, time=curves.time + shift.seconds) if shift else curves
    time, own_times = common_times(moved, scene)
    outside = 1 - (time[-1] - time[0]) / (moved.time[-1] - moved.time[0])
    return AlignedCurve(moved, shift, time, own_times, max(0.0, outside))


def common_times(curves: Curves, scene: AnyScene) -> tuple[np.ndarray, bool]:
    """Return the times [n] at which a curve is compared, s, and whether they are its own. Raises
    SceneError if there are fewer than three."""
    ours = sample_times(scene)
    start, end = max(curves.time[0], ours[0]), min(curves.time[-1], ours[-1])
    slack = 1e-6 * scene.interval  # rounding of the same time in two files
    own, ours = (t[(t >= start - slack) & (t <= end + slack)] for t in (curves.time, ours))
    if min(len(own), len(ours)) < LEAST_SAMPLES:
        allowed = (
            f"must share at least {LEAST_SAMPLES} samples of either with the scene, 0 to "
            f"{scene.time.duration:g} s; a header such as time [ms] gives the unit, --align shifts "
            "its time"
        )
        span = f"{curves.time[0]:.6g} to {curves.time[-1]:.6g} s"
        raise SceneError(curves.file, "time", span, allowed)
    return (own, True) if len(own) <= len(ours) else (ours, False)


def distance_at(
    time: np.ndarray, one: np.ndarray, other: np.ndarray, spectral: bool = False
) -> Distance:
    """Return all distances of two waveforms [n] at times [n], which may be unevenly spaced.

    Misfit and peaks then use the samples, weighted by the trapezoidal rule; all else uses linear
    interpolation at the same number of equally spaced times.
    """
    even = np.linspace(time[0], time[-1], len(time))
    dt = even[1] - even[0]
    if np.abs(time - even).max() <= UNEVEN * dt:
        return distance(one, other, dt, spectral)
    found = distance(np.interp(even, time, one), np.interp(even, time, other), dt, spectral)
    half = np.diff(time) / 2
    weight = np.sqrt(np.append(half, 0) + np.append(0, half))
    peaks = np.abs(one).max(), np.abs(other).max()
    ratio = float(peaks[0] / peaks[1]) if peaks[1] > 0 else found.peak_ratio
    return found._replace(misfit=relative_l2(weight * one, weight * other), peak_ratio=ratio)


def static_level(place: Place, result: xr.Dataset) -> float:
    """Return the static value of a solution at a receiver before its load acts, SI."""
    level = place.waveform(static_state(result))
    return 0.0 if level is None else float(level[0])


def motions(curves: Curves, result: xr.Dataset) -> Iterator[tuple[Place, np.ndarray, np.ndarray]]:
    """Yield the places of a curve in a solution, and both waveforms minus the solution's static
    state, as a prestress is not part of the motion."""
    for place, values in curves.waveforms.items():
        ours = place.waveform(result)
        if ours is not None:
            static = static_level(place, result)
            yield place, values - static, ours - static


def _shift_onto(name: str, result: xr.Dataset, curves: Curves, scene: AnyScene) -> Shift:
    """Return the shift onto one solution; no shift if either is zero throughout.

    All places have equal weight: each waveform is divided by the solution's norm. The peak of the
    cross-correlation is refined by the correlation at the samples themselves, since interpolation
    between few, uneven samples displaces it by a part of their interval.
    """
    from scipy.optimize import minimize_scalar  # slow to import
    from scipy.signal import correlate

    own, dt = curves.time, scene.interval
    even = own[0] + dt * np.arange(int((own[-1] - own[0]) / dt + 1e-6) + 1)
    sizes = ((np.linalg.norm(ours), theirs, ours) for _, theirs, ours in motions(curves, result))
    waves = [(theirs / size, ours / size) for size, theirs, ours in sizes if size > 0]
    total = sum(correlate(ours, np.interp(even, own, theirs)) for theirs, ours in waves)
    if not np.any(total):
        return Shift()
    near = (int(np.argmax(total)) - len(even) + 1) * dt - even[0]

    def correlation(further: float) -> float:
        moved = replace(curves, time=own + near + further)
        time, _ = common_times(moved, scene)
        a = np.concatenate([np.interp(time, moved.time, theirs) for theirs, _ in waves])
        b = np.concatenate([np.interp(time, result.time.values, ours) for _, ours in waves])
        scale = np.linalg.norm(a) * np.linalg.norm(b)
        return float(a @ b / scale) if scale > 0 else 0.0

    reach = max(dt, float(np.diff(own).mean()))
    options = {"xatol": 1e-4 * dt}
    try:
        found = minimize_scalar(
            lambda s: -correlation(s), bounds=(-reach, reach), method="bounded", options=options
        )
    except SceneError:  # no overlap after this shift
        return Shift()
    return Shift(near + float(found.x), name, -float(found.fun))
