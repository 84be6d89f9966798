"""Amplitude spectra of waveforms, and those of a panel with the marks of its scene."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from compare.figures.charts.frequencies import Mark, marks_of
from compare.figures.overlays import UNITS
from compare.figures.subplots import Panel

TAPERED = 0.1  # of the waveform, at its end
PADDED = 2  # times its length, at least, to the next power of two
BEYOND = 2.5  # times the highest mark: where spectra end
OF_LOAD = 25.0  # times the load's frequency, at least


def tapered(values: np.ndarray) -> np.ndarray:
    """Return a waveform [n] whose last tenth is brought to zero by half a cosine (Harris 1978)."""
    count = len(values)
    room = max(1, round(TAPERED * count))
    window = np.ones(count)
    window[count - room :] = 0.5 * (1 + np.cos(np.pi * (np.arange(room) + 1) / room))
    return values * window


def spectrum(values: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (Hz) and dt |DFT| of the tapered waveform, padded by zeros: the size of
    its Fourier transform, per Hz.

    By Parseval's theorem the integral of twice its square over frequency is that of the squared
    tapered waveform over time.
    """
    length = 1 << int(np.ceil(np.log2(PADDED * len(values))))
    return np.fft.rfftfreq(length, dt), dt * np.abs(np.fft.rfft(tapered(values), length))


class Spectra(NamedTuple):
    """The spectra of one panel, over the frequencies that are drawn.

    marks : in order of frequency. curves : amplitude per Hz, SI, over frequency (Hz), by solution.
    """

    panel: Panel
    marks: list[Mark]
    curves: dict[str, pd.Series]

    @property
    def heading(self) -> str:
        """Receiver and variant."""
        return f"{self.panel.heading}, {self.panel.variant}"

    @property
    def unit(self) -> str:
        """The unit that is drawn."""
        return f"{UNITS[self.panel.quantity][1]}/Hz"

    @property
    def factor(self) -> float:
        """From SI to it."""
        return UNITS[self.panel.quantity][0]

    @property
    def peak(self) -> float:
        """The largest amplitude, in the drawn unit."""
        return self.factor * max(float(curve.max()) for curve in self.curves.values())

    def amplitude(self, frequency: float) -> float:
        """Return the largest of all curves at a frequency (Hz), in the drawn unit."""
        at = [np.interp(frequency, curve.index, curve.values) for curve in self.curves.values()]
        return self.factor * float(max(at))


def spectra_of(panel: Panel) -> Spectra:
    """Return the spectra of a panel's solutions."""
    marks = marks_of(panel)
    curves = {name: _drawn(curve, marks) for name, curve in panel.curves.items()}
    return Spectra(panel, marks, curves)


def _drawn(waveform: pd.Series, marks: list[Mark]) -> pd.Series:
    """Return a spectrum from one wave in the waveform's duration to beyond the marks."""
    time = waveform.index.values
    frequency, amplitude = spectrum(waveform.values, float(time[1] - time[0]))
    loads = [OF_LOAD * mark.frequency for mark in marks if mark.name == "load"]
    highest = max([BEYOND * mark.frequency for mark in marks] + loads, default=frequency[-1])
    kept = (frequency >= 1 / (time[-1] - time[0])) & (frequency <= highest)
    return pd.Series(amplitude[kept], np.round(frequency[kept], 9))
