"""How far one waveform is from another: one number for each way of being different.

Every function takes the waveform first and its reference second, both [time], equally sampled.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.signal import correlate, correlation_lags

#: What a misfit is taken over: the first group that is not zero throughout.
MEASURED = (("stress", "shear"), ("velocity",), ("rotation",))


class Distance(NamedTuple):
    """All distances of one waveform from its reference; nan where one has no meaning.

    misfit : relative L2. peak_ratio : of the largest magnitudes. delay : s, positive when late.
    period_ratio : of the mean periods. envelope, phase : single-valued misfits, None if not asked.
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
    """Return ||one - other|| / ||other||, over all samples of all receivers."""
    difference = float(np.linalg.norm(np.ravel(one - other)))
    return 0.0 if difference == 0 else _ratio(difference, float(np.linalg.norm(np.ravel(other))))


def misfit(one: xr.Dataset, other: xr.Dataset) -> float:
    """Return the relative L2 misfit of two results over what `recorded` returns of them."""
    a, b = recorded(one, other)
    return relative_l2(a, b) if a.size else 0.0


def recorded(one: xr.Dataset, other: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return all recorded stresses of two results, shears included, as one array each.

    Where both results have none or only zeros of these, all velocities, then all rotations; empty
    where nothing moves. A quantity that only one of them has is left out.
    """
    for quantities in MEASURED:
        shared = [q for q in quantities if q in one and q in other]
        a, b = (
            np.concatenate([np.zeros(0), *(r[q].values.ravel() for q in shared)])
            for r in (one, other)
        )
        if a.any() or b.any():
            return a, b
    return np.zeros(0), np.zeros(0)


def delay(one: np.ndarray, other: np.ndarray, dt: float) -> float:
    """Return by how much `one` arrives later, s: the peak of the cross-correlation.

    A parabola through the three largest values resolves a fraction of a sample.
    """
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

    This is 2 pi sqrt(m0 / m2) of the spectral moments, T_m02 of wave statistics.
    """
    rate = np.linalg.norm(np.gradient(waveform, dt))
    return float(2 * np.pi * np.linalg.norm(waveform) / rate) if rate > 0 else np.nan


def envelope_phase_misfit(one: np.ndarray, other: np.ndarray, dt: float) -> tuple[float, float]:
    """Return the single-valued envelope and phase misfits of Kristekova et al. (2006), by ObsPy.

    Bull. Seism. Soc. Am. 96, 1836-1850; over the band that holds the reference's energy. A
    reference that stands still, or swings more slowly than the record lasts, has no such band.
    """
    from obspy.signal.tf_misfit import em, pm

    period = mean_period(other, dt)
    if not one.any() or not period < dt * len(other):
        return np.nan, np.nan
    coarse = max(1, int(period / (40 * dt)))  # 40 samples a period: far above the band's end
    band = {"dt": dt * coarse, "fmin": 0.25 / period, "fmax": 4 / period, "nf": 24}
    pair = one[::coarse], other[::coarse]
    return float(em(*pair, **band)), float(pm(*pair, **band))


def _ratio(a: float, b: float) -> float:
    return float(a / b) if b > 0 else np.inf if a > 0 else np.nan
