"""Amplitude spectra of the waveforms, with the characteristic frequencies of the scene."""

from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from jointwave.compare.figures.charts.axes import GREY, chart, set_heading, share, solutions_legend
from jointwave.compare.figures.charts.marks import Frequency, marks_of
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import Panel, in_page, panels
from jointwave.compare.figures.style import style
from jointwave.compare.figures.units import DRAWN, UNITS, Unit
from jointwave.compare.misfit.pairs import Comparison

HEIGHT = 2.1  # inches
DECADES = 5  # drawn below the largest amplitude
NEAR = 1.25  # ratio of two marks below which their names are on opposite sides


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
    """The spectra of one panel, over the drawn frequencies.

    marks : in order of frequency. curves : amplitude per Hz, SI, over frequency (Hz), by solution.
    """

    panel: Panel
    marks: list[Frequency]
    curves: dict[str, pd.Series]

    @property
    def unit(self) -> Unit:
        """The drawn unit of the waveform."""
        return DRAWN[UNITS[self.panel.quantity]]

    @property
    def peak(self) -> float:
        """The largest amplitude, SI."""
        return max(float(curve.max()) for curve in self.curves.values())

    def amplitude(self, frequency: float) -> float:
        """Return the largest of all curves at a frequency (Hz), SI."""
        return max(float(np.interp(frequency, c.index, c.values)) for c in self.curves.values())


def spectra_of(panel: Panel) -> Spectra:
    """Return the spectra of a panel's solutions."""
    marks = marks_of(panel)
    curves = {name: _drawn(curve, marks) for name, curve in panel.curves.items()}
    return Spectra(panel, marks, curves)


def _drawn(waveform: pd.Series, marks: list[Frequency]) -> pd.Series:
    """Return a spectrum from one wave in the waveform's duration to beyond the marks."""
    time = waveform.index.values
    frequency, amplitude = spectrum(waveform.values, float(time[1] - time[0]))
    loads = [OF_LOAD * mark.frequency for mark in marks if mark.name == "load"]
    highest = max([BEYOND * mark.frequency for mark in marks] + loads, default=frequency[-1])
    kept = (frequency >= 1 / (time[-1] - time[0])) & (frequency <= highest)
    return pd.Series(amplitude[kept], np.round(frequency[kept], 9))


def spectra(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all spectra; empty without motion."""
    grid = [[spectra_of(panel) for panel in row] for row in in_page(panels(comparisons))]
    found = [s for row in grid for s in row]
    if not any(curve.any() for s in found for curve in s.curves.values()):
        return []
    draw = partial(_draw, grid, comparisons)
    title, caption, table = "Amplitude spectra", _caption(found), _table(found)
    return [SceneFigure(f"{name}-spectra", title, caption, draw, table, folded=True)]


def _caption(found: list[Spectra]) -> str:
    marks = {mark.name: mark for s in found for mark in s.marks}.values()
    known = ", ".join(f"{mark.words} {mark.frequency:.4g} Hz" for mark in marks)
    return (
        "Fourier amplitude of each waveform, its last tenth tapered by half a cosine and padded "
        "with zeros to twice its length or more." + (f" Dotted: {known}." if known else "")
    )


def _table(found: list[Spectra]) -> pd.DataFrame:
    columns = {
        f"{name} | {s.panel.heading} | {s.panel.variant} ({UNITS[s.panel.quantity]}/Hz)": curve
        for s in found
        for name, curve in s.curves.items()
    }
    return pd.DataFrame(columns).rename_axis("frequency (Hz)").reset_index()


def _draw(grid: list[list[Spectra]], comparisons: list[Comparison]) -> Figure:
    legend, columns = solutions_legend(comparisons, {}), max(map(len, grid))
    with chart(legend, len(grid), columns, [HEIGHT], "frequency (Hz)") as (figure, axes):
        of_unit: dict[Unit, list[tuple[Axes, Spectra]]] = {}
        for row, spectra in zip(axes[:, 0], grid, strict=True):
            for ax, one in zip(row, spectra, strict=False):
                of_unit.setdefault(one.unit, []).append((ax, one))
        for unit, drawn in of_unit.items():
            share(ax for ax, _ in drawn)
            peak = max(one.peak for _, one in drawn) or 1.0
            limits = 10.0**-DECADES * peak / unit.size, 2 * peak / unit.size
            for ax, one in drawn:
                _draw_spectra(ax, one)
                ax.set_ylim(*limits)
                _draw_marks(ax, one, limits)
    return figure


def _draw_spectra(ax: Axes, one: Spectra) -> None:
    set_heading(ax, f"{one.panel.heading}, {one.panel.variant}")
    ax.set_ylabel(f"{one.unit.name}/Hz")
    for name, curve in one.curves.items():
        ax.loglog(curve.index, curve / one.unit.size, **style(name).of_line())
    ax.yaxis.set_minor_locator(NullLocator())


def _draw_marks(ax: Axes, one: Spectra, limits: tuple[float, float]) -> None:
    """Draw the marks; a name is to the left if the next mark is near, and at the top where the
    curves are low."""
    following = [mark.frequency for mark in one.marks[1:]] + [np.inf]
    middle = limits[0] ** 0.25 * limits[1] ** 0.75
    for mark, after in zip(one.marks, following, strict=True):
        is_left = after < NEAR * mark.frequency
        is_high = one.amplitude(mark.frequency) / one.unit.size < middle
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
            fontsize=7,
            color=GREY,
        )
