"""Waveforms of the engines at a receiver, and the passages of a pulse in them.

A table has a column per engine over time (s): stress in Pa, compression positive, or motion along y
in SI. A number per engine is a Series. Arrival times are those of the homogenised bar: the wave
travels at the bar speed c from the loaded end and is reflected at both ends.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, in_order
from jointwave.compare.misfit.metrics import delay
from jointwave.compare.misfit.pairs import Comparison


def waveforms(comparison: Comparison, quantity: str, receiver: int = 0) -> pd.DataFrame:
    """Return the waveforms of a quantity at its receiver of this number."""
    found = {
        name: comparison.results[name][quantity][receiver].to_series()
        for name in in_order(comparison.results)
        if name in ENGINES
    }
    table = pd.DataFrame(found)
    return table.xs("y", level="axis") if table.index.nlevels > 1 else table


def peak(waves: pd.DataFrame) -> pd.Series:
    """Return the largest magnitude of each engine."""
    return waves.abs().max()


def by_engine(
    measure: Callable[[np.ndarray, np.ndarray], float], one: pd.DataFrame, other: pd.DataFrame
) -> pd.Series:
    """Return a measure of two waveforms for each engine."""
    return pd.Series({name: measure(one[name].values, other[name].values) for name in one})


def delays(one: pd.DataFrame, other: pd.DataFrame) -> pd.Series:
    """Return the delay of each engine's first waveform relative to the second, s."""
    dt = float(one.index[1] - one.index[0])
    return by_engine(lambda a, b: delay(a, b, dt), one, other)


def span(waves: pd.DataFrame, start: float, stop: float) -> pd.DataFrame:
    """Return the part from start to stop, s."""
    return waves[(waves.index >= start) & (waves.index < stop)]


def period(scene: Scene) -> float:
    """Return the load's time scale, s; a quarter of the record for a load without one."""
    return scene.load.time_scale or scene.time.duration / 4


def overlap(scene: Scene) -> float:
    """Return the distance from an end within which a pulse overlaps its reflection, c T / 2, m."""
    return calibrate(scene).bar_speed * period(scene) / 2


def arrivals(scene: Scene, y: float) -> np.ndarray:
    """Return the arrival times of the incident, first and second reflected pulse at y (m), s."""
    length = scene.pillar.length
    return np.array([y, 2 * length - y, 2 * length + y]) / calibrate(scene).bar_speed


def passages(comparison: Comparison, receiver: int = 0) -> list[pd.DataFrame]:
    """Return the stress of the three passages at a section, cut in the quiet times between them."""
    scene, waves = comparison.scene, waveforms(comparison, "stress", receiver)
    due, whole = arrivals(scene, scene.record.stress[receiver]), period(scene)
    rests = np.diff(due, prepend=-np.inf) - whole
    starts = [*(due - np.clip(rests / 2, whole / 4, whole)), due[-1] + 2 * whole]
    return [span(waves, starts[n], starts[n + 1]) for n in range(3)]


def signed_peaks(comparison: Comparison, receiver: int = 0) -> pd.DataFrame:
    """Return the peaks of the three passages at a section, Pa [engine, passage], each with the sign
    of its first half-cycle, the first that exceeds 0.3 of the peak."""
    found = []
    for part in passages(comparison, receiver):
        loud = part.where(part.abs() > 0.3 * peak(part)).bfill()
        found.append(np.sign(loud.iloc[0]).fillna(0.0) * peak(part))
    return pd.concat(found, axis=1)
