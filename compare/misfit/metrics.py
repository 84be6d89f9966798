"""The distance of one waveform from another, and of one result from another.

A waveform is one component of one quantity at one receiver, minus its static state, which is not
part of the motion. Nothing is pooled: the misfit of two results is that of the worst component that
carries its quantity's motion at a receiver (`weight`). Every function takes a waveform or result
first and its reference second, equally sampled.
"""

from collections.abc import Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError, require
from jointwave.compare.misfit.places import Place, shown, waveforms
from jointwave.compare.misfit.weight import EXCITED, weigh
from jointwave.results.dataset import A_RESULT
from jointwave.results.labels import QUANTITIES, UNITS

ALIKE = 1e-9  # tolerated difference of sample times, over the duration
MORLET, FREQUENCIES = 6, 24  # omega_0 of the wavelet; number of frequencies of a transform
SOFT = 1e5  # Pa s/m, impedance of soft soil
JUDGED = 10.0  # smallest misfit that a reference resolves, over its own error


class Distance(NamedTuple):
    """All distances of one waveform from its reference; NaN where undefined.

    misfit : relative L2. peak_ratio : of the largest magnitudes. delay : s, positive if late.
    period_ratio : of the mean periods. envelope, phase : single-valued misfits or None.
    """

    misfit: float
    peak_ratio: float
    delay: float
    period_ratio: float
    envelope: float | None = None
    phase: float | None = None


def distance(one: np.ndarray, other: np.ndarray, dt: float, spectral: bool = False) -> Distance:
    """Return all distances of `one` from `other`; `spectral` adds envelope and phase misfit."""
    envelope, phase = envelope_phase_misfit(one, other, dt) if spectral else (None, None)
    return Distance(
        relative_l2(one, other),
        _ratio(np.abs(one).max(), np.abs(other).max()),
        delay(one, other, dt),
        _ratio(mean_period(one, dt), mean_period(other, dt)),
        envelope,
        phase,
    )


def relative_l2(one: np.ndarray, other: np.ndarray) -> float:
    """Return ||one - other|| / ||other|| over all samples."""
    difference = float(np.linalg.norm(np.ravel(one - other)))
    return 0.0 if difference == 0 else _ratio(difference, float(np.linalg.norm(np.ravel(other))))


class Worst(NamedTuple):
    """The misfit of a waveform from its reference, or that of the worst waveform of two results.

    misfit : relative L2 distance; with `of_all` relative to all motion of the quantity at the
    receiver, since the component carries less than 5 % of it in the reference. place : None without
    motion. floor : relative error of the reference itself, 0 for a closed form. faint : whether the
    waveform is too weak to decide the misfit of the results. one, other : waveform and reference
    [n], minus their static state.
    """

    misfit: float
    place: Any = None
    floor: float = 0.0
    of_all: bool = False
    faint: bool = False
    one: Any = None
    other: Any = None

    @property
    def judged(self) -> float:
        """The resolved misfit: at least ten times the reference's own error."""
        return max(self.misfit, JUDGED * self.floor)

    @property
    def where(self) -> str:
        """Quantity and receiver as text."""
        if self.place is None:
            return "nothing moves"
        return self.place.words + ", of all motion there" * self.of_all


def misfit(one: xr.Dataset, other: xr.Dataset) -> float:
    """Return the relative L2 misfit of two results of a scene: that of the worst waveform (one
    component of one quantity at one receiver, minus its static state) among those that carry at
    least 5 % of their quantity's motion at the receiver.

    Raises SceneError if the results share no receiver, or their times differ.
    """
    for result in (one, other):
        require(result, xr.Dataset, "misfit", "type", A_RESULT)
    if not set(waveforms(one)) & set(waveforms(other)):
        raise SceneError("misfit", "receivers", None, "the results share none")
    ours, theirs = one["time"].values[: other.sizes["time"]], other["time"].values
    if len(ours) < len(theirs) or np.abs(ours - theirs).max() > ALIKE * np.ptp(theirs):
        raise SceneError("misfit", "time", None, "the first result must have the other's samples")
    return worst(one, other).misfit


def worst(one: xr.Dataset, other: xr.Dataset, quantities: Sequence[str] = QUANTITIES) -> Worst:
    """Return the worst waveform of two results, of some quantities, that carries the motion."""
    found = [p for p in pairings(one, other) if p.place.quantity in quantities and not p.faint]
    return max(found, key=lambda w: w.judged, default=Worst(0.0))._replace(one=None, other=None)


def pairings(one: xr.Dataset, other: xr.Dataset) -> list[Worst]:
    """Return every waveform of both results, for as long as the reference is known.

    Left out are waveforms that are zero in both, or below a millionth of the largest motion in the
    reference unless the result moves there enough to decide; and all of them if both stay at rest,
    with no stress changing by a millionth of the load's or the static one.
    """
    until = other.attrs.get("known_until", np.inf)
    n = int(np.searchsorted(other["time"].values, until, side="right"))
    found = [(p, a[:n], b[:n]) for p, a, b in shared_waveforms(motion(one), motion(other))]
    sizes = [(place.quantity, max(rms(a), rms(b))) for place, a, b in found]
    changed = [size for quantity, size in sizes if quantity in UNITS[0]]
    moved = max((size for quantity, size in sizes if quantity in UNITS[1] + UNITS[3]), default=0.0)
    held = waveforms(static_state(other)) if _has_static_state(other) else {}
    still = [abs(float(v[0])) for place, v in held.items() if place.quantity in UNITS[0]]
    least, load = max(still, default=0.0), other.attrs.get("peak_load", 0.0)
    if changed and max(changed) < EXCITED * max(least, load):
        if max(changed) < EXCITED * least or SOFT * moved < EXCITED * load:
            return []
        found = [one for one in found if one[0].quantity not in UNITS[0]]  # pieces that fly off
    weight = weigh([place for place, *_ in found], np.array([rms(b) for *_, b in found]))
    kept, errors = [], waveforms(other, "_error")
    for (place, a, b), norm, least, excited in zip(
        found, *map(np.ndarray.tolist, weight), strict=True
    ):
        error = float(errors[place][0]) if place in errors else 0.0
        here, whole = shown(place, one), norm or inf
        decides = Worst(rms(a - b) / whole, here, error / whole, True, False, a, b)
        if not 0 < least <= decides.judged:
            floor = _ratio(error, rms(b)) if error else 0.0
            decides = Worst(relative_l2(a, b), here, floor, False, least > 0, a, b)
        if (excited or not decides.faint) and (a.any() or b.any()):
            kept.append(decides)
    return kept


def shared_waveforms(
    one: xr.Dataset, other: xr.Dataset
) -> list[tuple[Place, np.ndarray, np.ndarray]]:
    """Return the waveforms [n] of two results at every place that both have."""
    ours, theirs = waveforms(one), waveforms(other)
    return [(place, wave, theirs[place]) for place, wave in ours.items() if place in theirs]


def motion(result: xr.Dataset) -> xr.Dataset:
    """Return the quantities of a result minus their static state."""
    still = static_state(result)
    return result[list(still)] - still.isel(time=0, drop=True)


def static_state(result: xr.Dataset) -> xr.Dataset:
    """Return the quantities of a result before its load, at one time.

    The static state is the prestress of a section, or the whole first sample under static gravity
    or, in a rock mass, under prestress.
    """
    first = result[[name for name, of in result.items() if "time" in of.dims]].isel(time=[0])
    if _has_static_state(result):
        return first
    stress = float(result.attrs.get("prestress", 0.0))
    values = {k: np.full(x.shape, stress if k == "stress" else 0.0) for k, x in first.items()}
    return first.copy(data=values)


def _has_static_state(result: xr.Dataset) -> bool:
    """Return whether a result starts from a computed static state, which has a tolerance."""
    starts, given = result.attrs.get("starts"), "prestress" in result.attrs
    return starts == "at rest under gravity" or (starts == "prestressed" and not given)


def rms(waveform: np.ndarray) -> float:
    """Return the root mean square of a waveform [n]."""
    return float(np.linalg.norm(waveform) / np.sqrt(max(waveform.size, 1)))


def delay(one: np.ndarray, other: np.ndarray, dt: float) -> float:
    """Return the delay of `one`, s, from the peak of the cross-correlation.

    A parabola through the three largest values resolves a fraction of a sample.
    """
    from scipy.signal import correlate, correlation_lags  # slow to import

    if not one.any() or not other.any():
        return np.nan
    c = correlate(one, other)
    i = int(np.argmax(c))
    shift = 0.0
    if 0 < i < len(c) - 1:
        left, top, right = c[i - 1 : i + 2]
        shift = 0.5 * (left - right) / (left - 2 * top + right)
    return float((correlation_lags(len(one), len(other))[i] + shift) * dt)


def mean_period(waveform: np.ndarray, dt: float) -> float:
    """Return 2 pi ||s|| / ||ds/dt||, s: the period of a sine, the mean period of any other wave.

    This is 2 pi sqrt(m0 / m2) of the spectral moments, T_m02 of wave statistics. Differences of
    samples are 2 sin(pi dt / T) of a sine, however coarse.
    """
    size, half = np.linalg.norm(waveform), np.linalg.norm(np.diff(waveform)) / 2
    return float(np.pi * dt / np.arcsin(half / size)) if half > 0 else np.nan


def envelope_phase_misfit(one: np.ndarray, other: np.ndarray, dt: float) -> tuple[float, float]:
    """Return the single-valued envelope and phase misfits of Kristekova et al. (2006).

    Bull. Seism. Soc. Am. 96, 1836-1850; of ObsPy's wavelet transforms over the band that contains
    the reference's energy. NaN if there is no such band: the reference is at rest or its period
    exceeds the record.
    """
    from obspy.signal.tf_misfit import cwt  # slow to import

    period = mean_period(other, dt)
    if not one.any() or not period < dt * len(other):
        return np.nan, np.nan
    coarse = max(1, int(period / (40 * dt)))  # 40 samples per period, well above the band
    pair, band = (one[::coarse], other[::coarse]), (0.25 / period, 4 / period)
    W, R = (cwt(x, dt * coarse, MORLET, *band, FREQUENCIES) for x in pair)
    size, phase = np.abs(R), np.angle(W * R.conj()) / np.pi
    parts = np.abs(W) - size, size * phase
    envelope, phased = (float(np.linalg.norm(x) / np.linalg.norm(size)) for x in parts)
    return envelope, phased


def _ratio(a: float, b: float) -> float:
    return float(a / b) if b > 0 else np.inf if a > 0 else np.nan
