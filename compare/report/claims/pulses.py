"""Pulses in waveforms: time span, peak, period and delay of each passage.

A waveform is a pandas Series over time in s; stress in Pa, compression positive, or velocity in
m/s. Passages are those of the homogenised bar: the wave travels from the loaded end at the bar
speed c and back from the other end.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, in_order
from jointwave.compare.misfit.pairs import Comparison

T = TypeVar("T")


def waveforms(comparison: Comparison, quantity: str, index: int) -> dict[str, pd.Series]:
    """Return each engine's waveform at the index-th receiver of a quantity, along y."""
    return {
        name: _along_axis(comparison.results[name], quantity, index)
        for name in in_order(comparison.results)
        if name in ENGINES
    }


def by_engine(
    comparison: Comparison, quantity: str, measure: Callable[[pd.Series], T]
) -> dict[str, T]:
    """Return what is measured of each engine's waveform at the first receiver of a quantity."""
    return {name: measure(w) for name, w in waveforms(comparison, quantity, 0).items()}


def signed_peaks(comparison: Comparison, index: int = 0) -> dict[str, list[float]]:
    """Return by engine the peaks of the three passages at a section, Pa, each with the sign of its
    first half-cycle."""
    scene, y = comparison.scene, comparison.scene.record.stress[index]
    return {
        name: [
            first_swing(part) * peak(part) for part in (passage(w, scene, y, n) for n in range(3))
        ]
        for name, w in waveforms(comparison, "stress", index).items()
    }


def _along_axis(result: xr.Dataset, quantity: str, index: int) -> pd.Series:
    waveform = result[quantity][index]
    if "axis" in waveform.dims:
        waveform = waveform.sel(axis="y")
    return pd.Series(waveform.values, result.time.values)


def arrivals(scene: Scene, y: float) -> list[float]:
    """Return the arrival times of the incident, first and second reflected pulse at y (m), s."""
    length, c = scene.pillar.length, calibrate(scene).bar_speed
    return [y / c, (2 * length - y) / c, (2 * length + y) / c]


def period(scene: Scene) -> float:
    """Return the load's time scale, s; a quarter of the record for a load without one."""
    return scene.load.time_scale or scene.time.duration / 4


def span(waveform: pd.Series, start: float, stop: float) -> pd.Series:
    """Return the part from start to stop, s."""
    return waveform[(waveform.index >= start) & (waveform.index < stop)]


def passage(waveform: pd.Series, scene: Scene, y: float, n: int) -> pd.Series:
    """Return the n-th passage at y, between the middles of the quiet spans before and after it."""
    due, whole = [-np.inf, *arrivals(scene, y)], period(scene)
    rests = [due[i] - due[i - 1] - whole for i in range(1, len(due))]
    early = np.clip(np.array(rests) / 2, whole / 4, whole)
    starts = [*(np.array(due[1:]) - early), due[-1] + 2 * whole]
    return span(waveform, starts[n], starts[n + 1])


def peak(waveform: pd.Series) -> float:
    """Return the largest magnitude; 0 of an empty waveform."""
    return float(waveform.abs().max()) if len(waveform) else 0.0


def first_swing(waveform: pd.Series) -> float:
    """Return the sign of the first half-cycle that exceeds 0.3 of the peak; 0 without motion."""
    loud = waveform[waveform.abs() > 0.3 * peak(waveform)]
    return float(np.sign(loud.iloc[0])) if len(loud) else 0.0


def second_over_first(waveform: pd.Series) -> float:
    """Return the largest negative value after the largest positive one over the latter."""
    after = waveform[waveform.index >= waveform.idxmax()]
    return float(-after.min()) / float(waveform.max())


def sampling(waveform: pd.Series) -> float:
    """Return the time between samples, s."""
    return float(waveform.index[1] - waveform.index[0])


def quiet_share(waveform: pd.Series, scene: Scene) -> pd.Series:
    """Return the reflection of the rigid chain's quiet end (9), given that of a free end.

    With the wave exp(i omega t - i theta j) in blocks of mass m, z = exp(-i theta), k* = k (1 +
    i omega eta) and Z = rho c A: z + 1/z = 2 - m omega^2/k*; the dashpot on the full-mass end block
    reflects -(k* (z - 1) + i omega Z)/(k* (1/z - 1) + i omega Z), the free end z. Undamped, their
    ratio has the magnitude tan(theta/4).
    """
    p = calibrate(scene)
    size = 2 * len(waveform)
    omega = 2 * np.pi * np.fft.rfftfreq(size, sampling(waveform))[1:]
    k = p.regular_stiffness * p.area * (1 + 1j * omega * (p.time_constant or 0.0))
    half = 1 - p.block_mass * omega**2 / (2 * k)
    z = half - 1j * np.sqrt(1 - half**2)  # the root that travels or decays forwards
    z = np.where(np.abs(z) > 1 + 1e-12, 1 / z, z)
    dashpot = 1j * omega * p.impedance * p.area
    ratio = -(k * (z - 1) + dashpot) / (k * (1 / z - 1) + dashpot) / z
    share = np.fft.irfft(np.r_[0, ratio] * np.fft.rfft(waveform.values, size), size)
    return pd.Series(share[: len(waveform)], waveform.index)


def quiet_harmonic(scene: Scene) -> float:
    """Return |R| = tan(k d / 4) of the quiet end for a harmonic of the load's period, undamped."""
    p = calibrate(scene)
    theta = 2 * np.arcsin(min(1.0, np.pi * p.spacing / (p.bar_speed * period(scene))))
    return float(np.tan(theta / 4))
