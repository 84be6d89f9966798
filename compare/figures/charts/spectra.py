"""Amplitude spectra of the waveforms, with the characteristic frequencies of the scene."""

from math import pi
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import label_of
from jointwave.compare.figures.charts.axes import chart, set_heading
from jointwave.compare.figures.export import SceneFigure
from jointwave.compare.figures.receivers import Panel, in_rows
from jointwave.compare.figures.style import GREY, style
from jointwave.compare.figures.units import DRAWN
from jointwave.compare.misfit.pairs import Comparison

HEIGHT = 2.1  # inches
DECADES = 5  # drawn below the largest amplitude
NEAR = 1.25  # ratio of two marks below which their names are on opposite sides
TAPERED = 0.1  # of the waveform, at its end
PADDED = 2  # times its length, at least, to the next power of two
BEYOND = 2.5  # times the highest mark: where spectra end
OF_LOAD = 25.0  # times the load's frequency, at least


class Frequency(NamedTuple):
    """A frequency (Hz) that is marked, and its meaning, short and in words."""

    name: str
    frequency: float
    words: str


def marks_of(panel: Panel) -> list[Frequency]:
    """Return the marks of a panel in order of frequency: of the load and, of a pillar, the cut-off
    of a chain, omega = 2 sqrt(k/m) = 2 c/d (Brillouin 1946), of the least c/d: that of longitudinal
    waves or, if blocks do not rotate, of shear waves."""
    scene, (quantity, component, _) = panel.comparison.scene, panel.place
    periods = {one.period for one in scene.pulses if one.period}
    found, rate = [Frequency("load", 1 / period, "1/T of the load") for period in periods], 0.0
    if scene.is_column:
        p = calibrate(scene)
        along = quantity in ("stress", "velocity") and component in ("", "y")
        if along or len(p.each) > 1:
            rate = min(one.bar_speed / one.spacing for one in p.each)
        elif scene.motion.rotation == "none" and quantity != "rotation":
            rate = p.shear_speed / p.spacing
    if rate:
        found.append(Frequency("chain cut-off", rate / pi, "cut-off of the chain of blocks"))
    return sorted(found, key=lambda mark: mark.frequency)


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


def spectra_of(panel: Panel) -> pd.DataFrame:
    """Return the spectra of a panel's solutions, a column each: amplitude per Hz, SI, over
    frequency (Hz), from one wave in the duration to beyond the marks."""
    time = panel.curves.index.values
    frequency, amplitude = spectrum(panel.curves.to_numpy(), float(time[1] - time[0]))
    ends = [(OF_LOAD if m.name == "load" else BEYOND) * m.frequency for m in marks_of(panel)]
    drawn = (frequency >= 1 / (time[-1] - time[0])) & (frequency <= max(ends, default=np.inf))
    return pd.DataFrame(amplitude[drawn], np.round(frequency[drawn], 9), panel.curves.columns)


def spectra(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all spectra; empty without motion."""
    grid = [[(panel, spectra_of(panel)) for panel in row] for row in in_rows(comparisons)]
    found = [one for row in grid for one in row]
    if not any(curves.to_numpy().any() for _, curves in found):
        return []
    marks = {mark.name: mark for panel, _ in found for mark in marks_of(panel)}.values()
    known = ", ".join(f"{mark.words} {mark.frequency:.4g} Hz" for mark in marks)
    caption = (
        "Fourier amplitude of each waveform, its last tenth tapered by half a cosine and padded "
        "with zeros to twice its length or more." + (f" Dotted: {known}." if known else "")
    )
    columns = {
        panel.column(str(solution), "/Hz"): curve
        for panel, curves in found
        for solution, curve in curves.items()
    }
    table = pd.DataFrame(columns).rename_axis("frequency (Hz)").reset_index()
    title = "Amplitude spectra"
    return [SceneFigure(f"{name}-spectra", title, caption, _draw(grid), table, folded=True)]


def _draw(grid: list[list[tuple[Panel, pd.DataFrame]]]) -> Figure:
    peaks = pd.Series({panel.unit: 0.0 for row in grid for panel, _ in row})
    for panel, curves in (one for row in grid for one in row):
        peaks[panel.unit] = max(peaks[panel.unit], curves.max(axis=None))
    with chart(len(grid), max(map(len, grid)), [HEIGHT], "frequency (Hz)") as (figure, axes):
        for row, found in zip(axes[:, 0], grid, strict=True):
            for ax, (panel, curves) in zip(row, found, strict=False):
                _draw_spectra(ax, panel, curves, peaks[panel.unit] or 1.0)
    return figure


def _draw_spectra(ax: Axes, panel: Panel, curves: pd.DataFrame, peak: float) -> None:
    """Draw the spectra of a panel and its marks; peak : of all panels with its unit, SI."""
    unit = DRAWN[panel.unit]
    set_heading(ax, panel.heading)
    for name, curve in (curves / unit.size).items():
        ax.loglog(curve, label=label_of(str(name)), **style(str(name)).of_line())
    top = peak / unit.size
    ax.set(ylabel=f"{unit.name}/Hz", ylim=(10.0**-DECADES * top, 2 * top))
    ax.yaxis.set_minor_locator(NullLocator())
    _draw_marks(ax, marks_of(panel), curves.max(axis="columns"), 10.0 ** (-DECADES / 4) * peak)


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
