"""Amplitude spectra of the waveforms, with the characteristic frequencies of the scene."""

from math import pi
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.engines import label_of
from jointwave.compare.figures.export import SceneFigure, chart, set_heading
from jointwave.compare.figures.receivers import Panel, in_rows, table_of
from jointwave.compare.figures.style import DRAWN, GREY, style
from jointwave.compare.misfit.pairs import Comparison

HEIGHT = 2.1  # inches
DECADES = 5  # drawn below the largest amplitude
NEAR = 1.25  # ratio of two marks below which their names are on opposite sides
TAPERED = 0.1  # of the waveform, at its end
PADDED = 2  # least ratio of the padded length (a power of two) to the length
LOAD, CUT_OFF = "load", "chain cut-off"
#: Marks in words, and the end of the spectra over the frequency of the mark.
MARKS = {LOAD: ("1/T of the load", 25.0), CUT_OFF: ("cut-off of the chain of blocks", 2.5)}


def marks_of(panel: Panel) -> list[tuple[str, float]]:
    """Return the marks of a panel, name and frequency (Hz), in order: the load and, for a pillar,
    the cut-off of the chain of blocks, omega = 2 sqrt(k/m) = 2 c/d (Brillouin 1946) with the least
    c/d, for longitudinal waves or, if blocks do not rotate, shear waves."""
    scene, (quantity, component, _) = panel.comparison.scene, panel.place
    found = [(LOAD, 1 / one.period) for one in scene.pulses if one.period]
    if scene.is_column:
        p = calibrate(scene)
        along = quantity in ("stress", "velocity") and component in ("", "y")
        if along or len(p.each) > 1:
            found.append((CUT_OFF, min(one.bar_speed / one.spacing for one in p.each) / pi))
        elif scene.motion.rotation == "none" and quantity != "rotation":
            found.append((CUT_OFF, p.shear_speed / p.spacing / pi))
    return sorted(found, key=lambda mark: mark[1])


def tapered(values: np.ndarray) -> np.ndarray:
    """Return waveforms [n, ...] with the last tenth tapered by half a cosine (Harris 1978)."""
    room = max(1, round(TAPERED * len(values)))
    after = np.arange(1 - len(values), 1) / room + 1  # from 0 to 1 within the last tenth
    window = 0.5 * (1 + np.cos(np.pi * np.clip(after, 0, 1)))
    return (values.T * window).T


def spectrum(values: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (Hz) and Fourier amplitudes per Hz, dt |DFT|, of waveforms [n, ...].

    The waveforms are tapered and padded. By Parseval's theorem twice the squared amplitude,
    integrated over frequency, is the squared tapered waveform, integrated over time.
    """
    length = 1 << int(np.ceil(np.log2(PADDED * len(values))))
    return np.fft.rfftfreq(length, dt), dt * np.abs(np.fft.rfft(tapered(values), length, axis=0))


def spectra_of(panel: Panel) -> pd.DataFrame:
    """Return the spectra of a panel's solutions, a column each: amplitude per Hz, SI, over
    frequency (Hz), from 1 / duration to beyond the marks."""
    time = panel.curves.index.values
    frequency, amplitude = spectrum(panel.curves.to_numpy(), float(time[1] - time[0]))
    end = max((MARKS[name][1] * at for name, at in marks_of(panel)), default=np.inf)
    drawn = (frequency >= 1 / (time[-1] - time[0])) & (frequency <= end)
    return pd.DataFrame(amplitude[drawn], np.round(frequency[drawn], 9), panel.curves.columns)


def spectra(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all spectra; empty without motion."""
    grid = [[(panel, spectra_of(panel)) for panel in row] for row in in_rows(comparisons)]
    found = [one for row in grid for one in row]
    if not any(curves.to_numpy().any() for _, curves in found):
        return []
    marks = dict(mark for panel, _ in found for mark in marks_of(panel))
    known = ", ".join(f"{MARKS[mark][0]} {frequency:.4g} Hz" for mark, frequency in marks.items())
    caption = (
        "Fourier amplitude of each waveform, its last tenth tapered by half a cosine and padded "
        "with zeros to twice its length or more." + (f" Dotted: {known}." if known else "")
    )
    columns = {
        panel.column(str(solution), "/Hz"): curve
        for panel, curves in found
        for solution, curve in curves.items()
    }
    table = table_of(columns, "frequency (Hz)")
    return [SceneFigure(f"{name}-spectra", "Amplitude spectra", caption, _draw(grid), table, True)]


def _draw(grid: list[list[tuple[Panel, pd.DataFrame]]]) -> Figure:
    peaks: dict[str, float] = {}  # largest value of all panels by unit, SI
    for panel, curves in (one for row in grid for one in row):
        peaks[panel.unit] = max(peaks.get(panel.unit, 0.0), curves.max(axis=None))
    with chart(len(grid), max(map(len, grid)), [HEIGHT], "frequency (Hz)") as (figure, axes):
        for row, found in zip(axes[:, 0], grid, strict=True):
            for ax, (panel, curves) in zip(row, found, strict=False):
                unit, peak = DRAWN[panel.unit], peaks[panel.unit] or 1.0
                set_heading(ax, panel.heading)
                for name, curve in (curves / unit.size).items():
                    ax.loglog(curve, label=label_of(str(name)), **style(str(name)).of_line())
                top = peak / unit.size
                ax.set(ylabel=f"{unit.name}/Hz", ylim=(10.0**-DECADES * top, 2 * top))
                ax.yaxis.set_minor_locator(NullLocator())
                _draw_marks(ax, panel, curves.max(axis="columns"), 10.0 ** (-DECADES / 4) * peak)
    return figure


def _draw_marks(ax: Axes, panel: Panel, largest: pd.Series, middle: float) -> None:
    """Draw the marks. A name is on the left if the next mark is near, and at the top if the curves,
    at most `largest`, are below `middle` there."""
    marks = marks_of(panel)
    following = [at for _, at in marks[1:]] + [np.inf]
    for (name, at), after in zip(marks, following, strict=True):
        is_left, is_high = after < NEAR * at, np.interp(at, largest.index, largest) < middle
        ax.axvline(at, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
        look: dict[str, Any] = {"rotation": 90, "fontsize": "x-small", "color": GREY}
        look |= {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        look |= {"ha": "right", "xytext": (-2, 0)} if is_left else {"ha": "left", "xytext": (2, 0)}
        place = (at, 0.97 if is_high else 0.03)
        ax.annotate(name, place, va="top" if is_high else "bottom", **look)
