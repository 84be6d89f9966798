"""Amplitude spectra of the waveforms, with the characteristic frequencies of the scene."""

import numpy as np
import pandas as pd

from compare.figures.charts.chart import Chart, ChartLine, Mark, Subplot, solutions_legend
from compare.figures.charts.spectrum import Spectra, spectra_of
from compare.figures.figure import SceneFigure, chart_figure
from compare.figures.style import style
from compare.figures.subplots import UNITS, in_page, panels
from compare.misfit.pairs import Comparison

DECADES = 5  # drawn below the largest amplitude
NEAR = 1.25  # ratio of two marks below which their names are on opposite sides


def spectra(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all spectra, None without motion."""
    grid = [[spectra_of(panel) for panel in row] for row in in_page(panels(comparisons))]
    found = [s for row in grid for s in row]
    if not any(curve.any() for s in found for curve in s.curves.values()):
        return []
    peaks = {s.unit: max(t.peak for t in found if t.unit == s.unit) or 1.0 for s in found}
    chart = Chart(
        [
            [[_subplot(s, peaks[s.unit], f"{i}-{j}")] for j, s in enumerate(row)]
            for i, row in enumerate(grid)
        ],
        "frequency (Hz)",
        solutions_legend(comparisons, given=False),
        is_log=True,
    )
    title, caption = "Amplitude spectra", _caption(found)
    return [chart_figure(f"{name}-spectra", title, caption, chart, _table(found), folded=True)]


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


def _subplot(one: Spectra, peak: float, place: str) -> Subplot:
    """Return the axes of one receiver's spectra; peak : the largest of all in its unit."""
    limits = 10.0**-DECADES * peak, 2 * peak
    lines = [
        ChartLine(
            name,
            style(name),
            curve.index.values,
            one.factor * curve.values,
            f"%{{y:.3g}} {one.unit} at %{{x:.4~g}} Hz<extra>{name}</extra>",
            f"{place}-{name}",
        )
        for name, curve in one.curves.items()
    ]
    return Subplot(
        one.heading,
        one.unit,
        lines,
        share=one.unit,
        is_log=True,
        limits=limits,
        marks=tuple(_marks(one, limits)),
    )


def _marks(one: Spectra, limits: tuple[float, float]) -> list[Mark]:
    """Return the marks; a name is to the left if the next mark is near, and at the top where the
    curves are low."""
    following = [mark.frequency for mark in one.marks[1:]] + [np.inf]
    low = limits[0] ** 0.25 * limits[1] ** 0.75
    return [
        Mark(
            mark.frequency,
            mark.name,
            after < NEAR * mark.frequency,
            one.amplitude(mark.frequency) < low,
        )
        for mark, after in zip(one.marks, following, strict=False)
    ]
