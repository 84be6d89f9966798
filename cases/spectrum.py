"""Spectrum of a load: the highest frequency that matters, and the wave that it drives."""

from functools import lru_cache
from math import asin, pi, tan
from typing import NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory, Recorded, Step, periodic
from jointwave.cases.loads import history_of
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.scene import Scene

#: Part below its highest frequency of a load's energy, the integral of its square over time.
#: A single sine cycle ends at 1.50 / T, a Ricker wavelet at 1.67 / T.
SHARE = 0.95
LEAST_BLOCKS = 10.0  #: and elements, in a wavelength that they resolve
BINS, PADDING, MOST_CYCLES = 4096, 8, 32


class ShortestWave(NamedTuple):
    """The slowest wave that a load drives, at the load's highest frequency.

    frequency : Hz. speed : m/s. blocks : how many of them a wavelength takes. cut_off : Hz, above
    which a row of rigid blocks passes nothing.
    """

    frequency: float
    speed: float
    blocks: float
    cut_off: float

    @property
    def reflection(self) -> float:
        """tan(k d / 4), the reflection by a quiet end on a rigid block (Guo & Li 2002, (9))."""
        if self.frequency >= self.cut_off:
            return 1.0
        return tan(asin(self.frequency / self.cut_off) / 2)


def shortest_wave(scene: Scene, p: Properties) -> ShortestWave | None:
    """Return the wave with the shortest wavelength under a scene's load; None without a load."""
    frequency = highest_frequency(scene)
    if frequency is None:
        return None
    sheared = scene.load.is_across or scene.load.arm is not None
    bar = min(p.each, key=lambda one: one.bar_speed / one.spacing)
    speed = bar.shear_speed if sheared else bar.bar_speed
    blocks = speed / (frequency * bar.spacing)
    return ShortestWave(frequency, speed, blocks, speed / (pi * bar.spacing))


def highest_frequency(scene: AnyScene) -> float | None:
    """Return the frequency (Hz) below which 95 % of the energy of each load or wave lies.

    Of a step, which never ends, of what acts until the end of the scene; of a shaken base of its
    velocity. None where nothing acts.
    """
    found = (frequency_of(one, scene.time.duration) for one in scene.pulses)
    return max((one for one in found if one is not None), default=None)


def frequency_of(pulse: Pulse, duration: float) -> float | None:
    """Return that of one load or wave in a scene of this duration (s)."""
    if not pulse.amplitude:
        return None
    if pulse.history is None and (pulse.period or pulse.shape == "step"):
        cycles = min(pulse.cycles or 1, MOST_CYCLES)
        return _at_unit_period(pulse.shape, cycles) / (pulse.period or duration)
    history = history_of(pulse, 1.0)
    assert isinstance(history, Recorded)
    if not history.stress.any():
        return None
    start, end = float(history.time[0]), float(history.time[-1])
    if pulse.quantity == "acceleration":
        edges = np.linspace(start, end, BINS)
        return _below(history.impulse(edges), (end - start) / BINS)
    a, b = history.stress[:-1], history.stress[1:]  # piecewise linear
    energy = float(np.diff(history.time) @ (a * a + a * b + b * b)) / 3
    return _below(*_means(history, start, end), energy)


@lru_cache
def _at_unit_period(shape: str, cycles: int) -> float:
    """Return the frequency of a pulse over its period, of a step over the time that it acts."""
    load = Step(1.0) if shape == "step" else periodic(shape, 1.0, 1.0, cycles)
    return _below(*_means(load, 0.0, load.end or 1.0))


def _means(load: LoadHistory, start: float, end: float) -> tuple[np.ndarray, float]:
    """Return the mean of a load in each of equal bins, and their length."""
    edges = np.linspace(start, end, BINS + 1)
    length = (end - start) / BINS
    return np.diff(load.impulse(edges)) / length, length


def _below(values: np.ndarray, length: float, energy: float = 0.0) -> float:
    """Return the frequency below which the share of the energy lies, at most the Nyquist one.

    energy : that of the load itself, where its bins of a length (s) may have lost some.
    """
    count = PADDING * BINS
    power = np.abs(np.fft.rfft(values, count)) ** 2 * 2 * length / count
    power[0] /= 2
    below = np.cumsum(power)  # up to half a line beyond each
    lines = (np.arange(power.size) + 0.5) / (count * length)
    return float(np.interp(SHARE * max(energy, below[-1]), below, lines))
