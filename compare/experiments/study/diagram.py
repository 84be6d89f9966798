"""Work-precision diagrams: error over seconds and over counted work, both axes logarithmic.

A cross is a point that is more accurate than its errors or finer points imply: it does not count.
Colours are those of models; markers show the order of the elements, open for implicit steps; dashes
show dimensions. Over seconds, thin dotted lines join equal digits per second.
"""

from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from compare.engines import names
from compare.experiments.study.findings import floor, front, is_known, measured
from compare.experiments.study.measure import PointRow
from compare.experiments.study.study import Study
from compare.figures.export import Drawn, blank, save
from compare.figures.style import style

ERRORS = {
    "numerical": "numerical error (own model)",
    "total": "numerical + modelling error",
}
COSTS = {"seconds": "seconds of stepping", "work": "degrees of freedom x force evaluations"}
MARKERS = "DPX*<>hpd8H"
OF_ORDER = {1: "o", 2: "s", 3: "^", 4: "v"}  # of elements
OF_DIM: dict[Any, Any] = {2: (0, (1, 1)), 3: (0, (5, 1, 1, 1))}  # dashes; a bar has none
IMPLICIT = (0, (5, 2))
LONG = 45  # characters of a legend's entry, three per row
SMALL: dict[str, Any] = {"fontsize": 6.5, "color": "#8a9299", "va": "bottom", "zorder": 1}
#: Colours of methods without one elsewhere, distinct from all others (Okabe & Ito 2008).
OTHERS = ("#6b6b6b", "#cc79a7", "#8a6d00", "#7a4fbf", "#000000")


def draw(
    name: str, study: Study, rows: list[PointRow], costs: dict[str, str] | None = None
) -> Figure:
    """Return a study's diagrams: one row per error, one column per cost.

    costs : attributes of the rows, with the words for each; default: counted work, and seconds if
        measured. The curve k of row i, column j is the SVG group NAME-i-j-k.
    """
    errors = [e for e in ERRORS if any(measured(rows, e, "work"))]
    costs = costs or {c: text for c, text in COSTS.items() if study.timed or c != "seconds"}
    with blank(0.6 + 0.09 * len(study.curves) + 3.4 * len(errors)) as figure:
        axes = figure.subplots(len(errors), len(costs), squeeze=False, sharey="row")
        for i, error in enumerate(errors):
            for j, cost in enumerate(costs):
                _draw_panel(axes[i, j], study, rows, error, cost, f"{name}-{i}-{j}")
                axes[i, j].set_xlabel(costs[cost])
            axes[i, 0].set_ylabel(ERRORS[error])
        entries: dict[str, Any] = {}
        for ax in axes.flat:
            entries |= zip(*ax.get_legend_handles_labels()[::-1], strict=True)
        columns, size = (3, 9.0) if max(map(len, entries)) < LONG else (2, 7.5)
        about: dict[str, Any] = {"ncols": columns, "fontsize": size, "frameon": False}
        figure.legend(entries.values(), entries, loc="outside upper center", **about)
    return figure


def write_diagram(folder: Path, name: str, study: Study, rows: list[PointRow]) -> Drawn | None:
    """Write the diagram into a folder; None if no error is known."""
    if not any(measured(rows, error, "work") for error in ERRORS):
        return None
    return save(draw(name, study, rows), folder, name, study.title)


def _draw_panel(
    ax: Axes, study: Study, rows: list[PointRow], error: str, cost: str, name: str
) -> None:
    least = floor(rows, error)
    best = [r for r in front(rows, error, cost) if is_known(r, error)]
    best = best if study.timed and len(study.curves) > 1 else []
    if best:
        ax.plot(
            [getattr(r, cost) for r in best],
            [r.held if error == "total" else getattr(r, error) for r in best],
            color="#bbbbbb",
            linewidth=5,
            zorder=1,
            label="Pareto front",
        )
    for k, curve in enumerate(study.curves):
        found = measured([r for r in rows if r.curve == curve.label], error, cost)
        x, y = ([getattr(r, name) for r in found] for name in (cost, error))
        (line,) = ax.loglog(x, y, label=curve.label, zorder=2, **line_style(study, k))
        line.set_gid(f"{name}-{k}")
    _draw_cancelling(ax, rows, error, cost, name)
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(which="major", axis="both" if cost == "work" else "y", color="#e4e7ea", linewidth=0.6)
    if least:
        ax.axhspan(0, least, color="#f2f2f2", zorder=0)
        ax.text(0.01, least, "fine runs differ", transform=ax.get_yaxis_transform(), **SMALL)
    if cost != "work":
        _draw_digits_per_second(ax)


def _draw_cancelling(ax: Axes, rows: list[PointRow], error: str, cost: str, name: str) -> None:
    """Mark by crosses the points whose errors cancel: far below the sum that counts."""
    shown = "measured" if error == "total" else error
    found = [
        r for r in measured(rows, shown, cost) if r.cancels and (error == "total" or isnan(r.total))
    ]
    if found:
        x, y = ([getattr(r, name) for r in found] for name in (cost, shown))
        words = "errors cancel, or a finer point is worse: excluded"
        (line,) = ax.plot(x, y, "x", color="#c0392b", markersize=6, zorder=3, label=words)
        line.set_gid(f"{name}-cancels")


def _draw_digits_per_second(ax: Axes) -> None:
    """Draw lines of -log10(error) / seconds at powers of ten, within the axes' limits."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    errors = np.geomspace(low, min(high, 0.9), 60)
    digits = -np.log10(errors)
    for power in range(-6, 9):
        seconds = digits / 10.0**power
        ax.plot(seconds, errors, color="#aab2b9", linewidth=0.7, linestyle=":", zorder=0)
        if 1.5 * left < seconds[0] < right:
            words = f"$10^{{{power}}}$" + (" digits/s" if seconds[0] * 10 > right else "")
            ax.text(seconds[0], low, words, ha="right", rotation=0, **SMALL)
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)


def line_style(study: Study, k: int) -> dict[str, Any]:
    """Return how matplotlib draws a curve."""
    changes = study.curves[k].changes
    order, dim = (changes.get(f"numerics.continuum.{key}") for key in ("order", "dim"))
    implicit = changes.get("numerics.continuum.scheme") == "implicit"
    return {
        "color": colour(study, k),
        "marker": OF_ORDER[order] if order else MARKERS[k % len(MARKERS)],
        "markersize": 4.5,
        "linewidth": 1.2,
        "linestyle": OF_DIM.get(dim, IMPLICIT if implicit else "-"),
        "markerfacecolor": "white" if implicit else None,
    }


def colour(study: Study, k: int) -> str:
    """Return the colour of a curve: its model's, as in all figures."""
    method = study.curves[k].method
    if method in names():
        return style(method).colour
    others = list(dict.fromkeys(c.method for c in study.curves if c.method not in names()))
    return OTHERS[others.index(method) % len(OTHERS)]
