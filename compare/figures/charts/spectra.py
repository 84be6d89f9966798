"""Amplitude spectra of the waveforms, with the frequencies that the scene is known by."""

from math import log10
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from compare.figures.charts import interactive
from compare.figures.charts.frequencies import Mark
from compare.figures.charts.spectrum import Spectra, spectra_of
from compare.figures.charts.waveforms import looks_of
from compare.figures.figure import Picture
from compare.figures.overlay_figures import add_legend
from compare.figures.style import RC, WIDTH, Style, style
from compare.figures.subplots import UNITS, in_page, panels
from compare.misfit.pairs import Comparison

MARK = "#5d6670"  # colour of the marks
DECADES = 5  # below the largest amplitude: what is drawn
NEAR = 1.25  # the ratio of two marks whose names stand on either side of them


def spectra(name: str, comparisons: list[Comparison]) -> list[Picture]:
    """Return the picture of all spectra, none where nothing moves."""
    found = [[spectra_of(panel) for panel in row] for row in in_page(panels(comparisons))]
    if not any(c.any() for row in found for s in row for c in s.curves.values()):
        return []
    return [
        Picture(
            f"{name}-spectra",
            "spectra",
            "Amplitude spectra",
            _caption([s for row in found for s in row]),
            _figure(f"{name}-spectra", found, comparisons),
            _table([s for row in found for s in row]),
            _plot([s for row in found for s in row], looks_of(comparisons, given=False)),
            True,
        )
    ]


def _caption(found: list[Spectra]) -> str:
    marks = {mark.name: mark for s in found for mark in s.marks}.values()
    known = ", ".join(f"{mark.words} {mark.frequency:.4g} Hz" for mark in marks)
    return (
        "Size of the Fourier transform of each waveform, its last tenth tapered by half a cosine "
        "and zeros added to at least twice its length." + (f" Dotted: {known}." if known else "")
    )


def _table(found: list[Spectra]) -> pd.DataFrame:
    """Return every drawn curve in SI: frequency first, one column a curve."""
    columns = {
        f"{name} | {s.panel.place} | {s.panel.variant} ({UNITS[s.panel.quantity]}/Hz)": curve
        for s in found
        for name, curve in s.curves.items()
    }
    return pd.DataFrame(columns).rename_axis("frequency (Hz)").reset_index()


def _figure(name: str, found: list[list[Spectra]], comparisons: list[Comparison]) -> Figure:
    rows, columns = len(found), max(map(len, found))
    alike = len({s.unit for row in found for s in row}) == 1
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(WIDTH, 1.0 + rows * 2.3))
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=alike)
        limits = iter(_limits([s for row in found for s in row]))
        for i, row in enumerate(found):
            for j, one in enumerate(row):
                _draw(axes[i, j], one, next(limits), f"{name}-{i}-{j}")
            for ax in axes[i, len(row) :]:
                ax.set_visible(False)
        for ax in axes[-1]:
            ax.set_xlabel("frequency (Hz)")
        for ax, row in zip(axes[:, 0], found, strict=True):
            ax.set_ylabel(row[0].unit)
        names = {n for row in found for s in row for n in s.curves}
        add_legend(figure, names, [])
    return figure


def _draw(ax: Axes, one: Spectra, limits: tuple[float, float], gid: str) -> None:
    ax.set_title(one.heading, pad=4)
    ax.set(xscale="log", yscale="log", ylim=limits)
    for name, curve in one.curves.items():
        (line,) = ax.plot(curve.index, one.factor * curve.values, **style(name).of_line())
        line.set_gid(f"{gid}-{name}")
    for mark, left, high in _placed(one, limits):
        ax.axvline(mark.frequency, color=MARK, linewidth=0.8, linestyle=":", zorder=1)
        ax.annotate(
            mark.name,
            (mark.frequency, 0.97 if high else 0.03),
            (-2 if left else 2, 0),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            rotation=90,
            ha="right" if left else "left",
            va="top" if high else "bottom",
            fontsize=7,
            color=MARK,
        )
    ax.margins(x=0)


def _limits(found: list[Spectra]) -> list[tuple[float, float]]:
    """Return the least and largest amplitude of each panel, all the same where units are."""
    peaks = {s.unit: max(t.peak for t in found if t.unit == s.unit) or 1.0 for s in found}
    return [(10.0**-DECADES * peaks[s.unit], 2 * peaks[s.unit]) for s in found]


def _placed(one: Spectra, limits: tuple[float, float]) -> list[tuple[Mark, bool, bool]]:
    """Return each mark, whether its name stands left of it, as where the next one is near, and
    whether it stands high, as where the curves are low."""
    following = [mark.frequency for mark in one.marks[1:]] + [np.inf]
    low = limits[0] ** 0.25 * limits[1] ** 0.75
    return [
        (mark, after < NEAR * mark.frequency, one.amplitude(mark.frequency) < low)
        for mark, after in zip(one.marks, following, strict=False)
    ]


def _plot(found: list[Spectra], looks: dict[str, Style]) -> dict[str, Any]:
    """Return the interactive figure: a panel a receiver, both axes logarithmic."""
    limits = _limits(found)
    rows = [
        interactive.Panel(s.heading, s.unit, 210, _logarithmic(reach))
        for s, reach in zip(found, limits, strict=True)
    ]
    x = {"title": {"text": "frequency (Hz)"}, "type": "log"}
    layout = interactive.layout(rows, x, len(looks))
    for i, (one, reach) in enumerate(zip(found, limits, strict=True)):
        placed = _placed(one, reach)
        layout.setdefault("shapes", []).extend(_line(mark, i) for mark, _, _ in placed)
        layout["annotations"] += [_name(mark, left, high, i) for mark, left, high in placed]
    traces = [
        _trace(name, curve, s, looks, i)
        for i, s in enumerate(found)
        for name, curve in s.curves.items()
    ]
    return {"data": interactive.in_layers(traces, looks), "layout": layout}


def _logarithmic(limits: tuple[float, float]) -> dict[str, Any]:
    reach = [log10(value) for value in limits]
    return {"type": "log", "range": reach, "exponentformat": "power", "dtick": 1}


def _trace(
    name: str, curve: pd.Series, one: Spectra, looks: dict[str, Style], row: int
) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        **interactive.places("x", curve.index.values),
        "y": interactive.packed(one.factor * curve.values),
        "yaxis": interactive.axis_of(row),
        "line": interactive.line(looks[name]),
        "hovertemplate": f"%{{y:.3g}} {one.unit} at %{{x:.4~g}} Hz<extra>{name}</extra>",
    }


def _line(mark: Mark, row: int) -> dict[str, Any]:
    return {
        "type": "line",
        "yref": f"{interactive.axis_of(row)} domain",
        "x0": mark.frequency,
        "x1": mark.frequency,
        "y0": 0,
        "y1": 1,
        "layer": "below",
        "line": {"color": MARK, "width": 1, "dash": "1px,3px"},
    }


def _name(mark: Mark, left: bool, high: bool, row: int) -> dict[str, Any]:
    return {
        "text": mark.name,
        "x": log10(mark.frequency),
        "xanchor": "right" if left else "left",
        "yref": f"{interactive.axis_of(row)} domain",
        "y": 0.98 if high else 0.02,
        "yanchor": "top" if high else "bottom",
        "textangle": -90,
        "showarrow": False,
        "font": {"size": 11, "color": MARK},
    }
