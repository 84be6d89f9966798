"""Amplitude spectra of the waveforms, with the characteristic frequencies of the scene."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from jointwave.compare.figures.charts.axes import chart, label_of, set_heading
from jointwave.compare.figures.charts.marks import Frequency, marks_of
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import Panel, in_rows
from jointwave.compare.figures.style import GREY, style
from jointwave.compare.figures.units import DRAWN, UNITS
from jointwave.compare.misfit.pairs import Comparison

HEIGHT = 2.1  # inches
DECADES = 5  # drawn below the largest amplitude
NEAR = 1.25  # ratio of two marks below which their names are on opposite sides
TAPERED = 0.1  # of the waveform, at its end
PADDED = 2  # times its length, at least, to the next power of two
BEYOND = 2.5  # times the highest mark: where spectra end
OF_LOAD = 25.0  # times the load's frequency, at least


def tapered(values: np.ndarray) -> np.ndarray:
    """Return waveforms [n, ...] whose last tenth is brought to zero by half a cosine (Harris
    1978)."""
    count = len(values)
    room = max(1, round(TAPERED * count))
    window = np.ones(count)
    window[count - room :] = 0.5 * (1 + np.cos(np.pi * (np.arange(room) + 1) / room))
    return (values.T * window).T


def spectrum(values: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (Hz) and dt |DFT| of the tapered waveforms [n, ...], padded by zeros: the
    size of their Fourier transforms, per Hz.

    By Parseval's theorem the integral of twice its square over frequency is that of the squared
    tapered waveform over time.
    """
    length = 1 << int(np.ceil(np.log2(PADDED * len(values))))
    return np.fft.rfftfreq(length, dt), dt * np.abs(np.fft.rfft(tapered(values), length, axis=0))


class Spectra(NamedTuple):
    """The spectra of one panel: amplitude per Hz, SI, over frequency (Hz), a column a solution;
    marks : in order of frequency."""

    panel: Panel
    marks: list[Frequency]
    curves: pd.DataFrame


def spectra_of(panel: Panel) -> Spectra:
    """Return the spectra of a panel's solutions, from one wave in its duration to beyond the
    marks."""
    marks, time = marks_of(panel), panel.curves.index.values
    frequency, amplitude = spectrum(panel.curves.to_numpy(), float(time[1] - time[0]))
    ends = [(OF_LOAD if m.name == "load" else BEYOND) * m.frequency for m in marks]
    drawn = (frequency >= 1 / (time[-1] - time[0])) & (frequency <= max(ends, default=np.inf))
    index, names = np.round(frequency[drawn], 9), panel.curves.columns
    return Spectra(panel, marks, pd.DataFrame(amplitude[drawn], index, names))


def spectra(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all spectra; empty without motion."""
    grid = [[spectra_of(panel) for panel in row] for row in in_rows(comparisons)]
    found = [s for row in grid for s in row]
    if not any(s.curves.to_numpy().any() for s in found):
        return []
    marks = {mark.name: mark for s in found for mark in s.marks}.values()
    known = ", ".join(f"{mark.words} {mark.frequency:.4g} Hz" for mark in marks)
    caption = (
        "Fourier amplitude of each waveform, its last tenth tapered by half a cosine and padded "
        "with zeros to twice its length or more." + (f" Dotted: {known}." if known else "")
    )
    columns = {
        f"{solution} | {place.heading} | {s.panel.variant} ({UNITS[place.quantity]}/Hz)": curve
        for s in found
        for place in [s.panel.place]
        for solution, curve in s.curves.items()
    }
    table = pd.DataFrame(columns).rename_axis("frequency (Hz)").reset_index()
    title = "Amplitude spectra"
    return [SceneFigure(f"{name}-spectra", title, caption, _draw(grid), table, folded=True)]


def _draw(grid: list[list[Spectra]]) -> Figure:
    peaks: dict[str, float] = {}
    for quantity, peak in (
        (s.panel.place.quantity, s.curves.max(axis=None)) for r in grid for s in r
    ):
        peaks[UNITS[quantity]] = max(peaks.get(UNITS[quantity], 0.0), peak)
    columns = max(map(len, grid))
    with chart(len(grid), columns, [HEIGHT], "frequency (Hz)") as (figure, axes):
        for row, found in zip(axes[:, 0], grid, strict=True):
            for ax, one in zip(row, found, strict=False):
                _draw_spectra(ax, one, peaks[UNITS[one.panel.place.quantity]] or 1.0)
    return figure


def _draw_spectra(ax: Axes, one: Spectra, peak: float) -> None:
    """Draw the spectra of a panel and its marks; peak : of all panels with its unit, SI."""
    unit = DRAWN[UNITS[one.panel.place.quantity]]
    set_heading(ax, f"{one.panel.place.heading}, {one.panel.variant}")
    for name, curve in one.curves.items():
        values = curve / unit.size
        ax.loglog(values.index, values, label=label_of(str(name)), **style(str(name)).of_line())
    ax.set(ylabel=f"{unit.name}/Hz", ylim=(10.0**-DECADES * peak / unit.size, 2 * peak / unit.size))
    ax.yaxis.set_minor_locator(NullLocator())
    _draw_marks(ax, one.marks, one.curves.max(axis="columns"), 10.0 ** (-DECADES / 4) * peak)


def _draw_marks(ax: Axes, marks: list[Frequency], largest: pd.Series, middle: float) -> None:
    """Draw the marks; a name is to the left if the next mark is near, and at the top where the
    curves, at most `largest`, are below `middle`."""
    following = [mark.frequency for mark in marks[1:]] + [np.inf]
    for mark, after in zip(marks, following, strict=True):
        is_left = after < NEAR * mark.frequency
        is_high = np.interp(mark.frequency, largest.index, largest) < middle
        ax.axvline(mark.frequency, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
        ax.annotate(
            mark.name,
            (mark.frequency, 0.97 if is_high else 0.03),
            (-2 if is_left else 2, 0),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            rotation=90,
            ha="right" if is_left else "left",
            va="top" if is_high else "bottom",
            fontsize="x-small",
            color=GREY,
        )
