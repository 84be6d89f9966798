"""Waveforms of all solutions at every receiver, over time."""

from typing import Any

import pandas as pd

from compare.figures import UNITS, draw
from compare.pairs import Comparison
from compare.panels import Panel, curve_table, panels
from compare.pictures import interactive
from compare.pictures.picture import Picture
from compare.style import GIVEN, Style, in_order, style

MOST = 1200  # samples of an interactive curve


def waveforms(name: str, comparisons: list[Comparison]) -> Picture:
    """Return the waveforms of every variant at every receiver, and curves of others beside them."""
    return Picture(
        f"{name}-waveforms",
        "waveforms",
        "Waveforms at the receivers",
        "Engines are wide and light, exact solutions dark and dashed over them, so that each is "
        "seen where several coincide. Stress is positive in compression.",
        draw(f"{name}-waveforms", comparisons),
        curve_table(comparisons).reset_index(),
        _plot(comparisons),
    )


def _plot(comparisons: list[Comparison]) -> dict[str, Any]:
    """Return the interactive figure: a panel a receiver, each solution switched in all at once."""
    shown = [panel for row in panels(comparisons) for panel in row]
    looks = looks_of(comparisons)
    traces = [
        _trace(curve, name, looks, panel, i)
        for i, panel in enumerate(shown)
        for name, curve in {**panel.curves, **panel.given}.items()
    ]
    labels = [f"{panel.quantity} ({UNITS[panel.quantity][1]})" for panel in shown]
    alike = {"matches": "y"} if len(set(labels)) == 1 else None
    rows = [
        interactive.Panel(f"{panel.place}, {panel.variant}", label, axis=alike if i else None)
        for i, (panel, label) in enumerate(zip(shown, labels, strict=True))
    ]
    found = interactive.in_layers(traces, looks)
    return {
        "data": found,
        "layout": interactive.layout(rows, {"title": {"text": "time (ms)"}}, len(looks)),
    }


def looks_of(comparisons: list[Comparison], given: bool = True) -> dict[str, Style]:
    """Return how the results of the variants and, with `given`, the curves of others are drawn, in
    the order of the legend."""
    names = {name for comparison in comparisons for name in comparison.results}
    files = [beside.curves.name for beside in comparisons[0].besides] if given else []
    return {name: style(name) for name in in_order(names)} | {
        file: GIVEN[k % len(GIVEN)] for k, file in enumerate(files)
    }


def _trace(
    curve: pd.Series, name: str, looks: dict[str, Style], panel: Panel, row: int
) -> dict[str, Any]:
    factor, unit = UNITS[panel.quantity]
    kept = curve.iloc[interactive.thinned(len(curve), MOST)]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        **interactive.places("x", 1e3 * kept.index.values),
        "y": interactive.packed(factor * kept.values),
        "yaxis": interactive.axis_of(row),
        "line": interactive.line(looks[name]),
        "hovertemplate": f"%{{y:.4g}} {unit} at %{{x:.2f}} ms<extra>{name}</extra>",
    }
