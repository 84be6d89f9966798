"""Waveforms at every receiver over time: as in the paper, and all solutions of a variant."""

from functools import partial

import pandas as pd
from matplotlib.figure import Figure

from jointwave.compare.figures.charts.axes import Legend, entry, given_entries, solutions_legend
from jointwave.compare.figures.charts.overlays import (
    Overlay,
    by_solution,
    by_variant,
    changed_key,
    draw_overlays,
)
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import Panel, curve_table, in_page, panels
from jointwave.compare.figures.units import UNITS
from jointwave.compare.misfit.pairs import Comparison

TITLE = "Waveforms at the receivers"
STYLES = (
    "Engines are wide and light, exact solutions dark and dashed over them, so that each is seen "
    "where several coincide."
)
BELOW = "Below, on a separate scale, the difference from the reference."
POSITIVE = "Stress is positive in compression."


def waveforms(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the waveforms of every variant at every receiver, with external curves.

    Variants that differ by one key share one pair of axes per engine, followed by all solutions of
    each variant.
    """
    receivers = [panel for row in panels(comparisons) for panel in row]
    overlaid = by_variant(comparisons)
    every = SceneFigure(
        f"{name}-waveforms",
        "Waveforms of every solution, variant by variant" if overlaid else TITLE,
        f"{STYLES} {BELOW} {POSITIVE}{_at_rest(receivers)}",
        partial(draw_solutions, comparisons),
        curve_table(comparisons).reset_index(),
        folded=bool(overlaid),
    )
    return [_of_variants(name, comparisons, overlaid, receivers), every] if overlaid else [every]


def draw_solutions(comparisons: list[Comparison]) -> Figure:
    """Return every solution of all variants; the k-th external file is the part given-k."""
    grid = [[by_solution(panel) for panel in row] for row in in_page(panels(comparisons))]
    return draw_overlays(grid, solutions_legend(comparisons, given_entries(comparisons)))


def draw_variants(grid: list[list[Overlay]]) -> Figure:
    """Return the variants of every engine in one pair of axes each."""
    found = {t.name: t.style for row in grid for overlay in row for t in overlay.traces}
    in_order = sorted(found.items(), key=lambda one: one[1].order)  # references last
    return draw_overlays(grid, Legend([entry(*one) for one in in_order], min(6, len(found))))


def _of_variants(
    name: str, comparisons: list[Comparison], grid: list[list[Overlay]], receivers: list[Panel]
) -> SceneFigure:
    caption = (
        f"Variants differ by {changed_key(comparisons)}; the first is wide and light, the last "
        f"thin and dark. Dotted: the reference, {_references(receivers)}. {BELOW} {POSITIVE}"
        f"{_at_rest(receivers)}"
    )
    title = "Variants overlaid, engine by engine"
    table = _variant_table([overlay for row in grid for overlay in row], receivers)
    return SceneFigure(f"{name}-variants", title, caption, partial(draw_variants, grid), table)


def _references(receivers: list[Panel]) -> str:
    found: dict[str, list[str]] = {}
    for panel in receivers:
        found.setdefault(panel.reference, []).append(panel.variant)
    if len(found) == 1:
        return next(iter(found))
    return ", ".join(f"{name} ({', '.join(dict.fromkeys(v))})" for name, v in found.items())


def _at_rest(receivers: list[Panel]) -> str:
    """Describe the static state subtracted from the waveforms; empty without one.

    It has no velocity, except for a remainder of dynamic relaxation.
    """
    states = dict.fromkeys(
        f"{panel.at_rest:.4g} {UNITS[panel.quantity]} ({panel.heading}, {panel.variant})"
        for panel in receivers
        if panel.at_rest and panel.quantity != "velocity"
    )
    return f" Waveforms are relative to the static state: {'; '.join(states)}." if states else ""


def _variant_table(overlays: list[Overlay], receivers: list[Panel]) -> pd.DataFrame:
    """Return curves of engines and of their references, SI: time first, one column each."""
    columns: dict[str, pd.Series] = {}
    for overlay in overlays:
        for trace in overlay.traces:
            if trace.part.startswith("variant"):
                name = f"{overlay.heading} | {trace.name} ({UNITS[overlay.quantity]})"
                columns[name] = trace.curve
    for panel in receivers:
        if panel.reference in (curves := panel.curves):
            name = f"{panel.reference}, {panel.heading} | {panel.variant} ({UNITS[panel.quantity]})"
            columns[name] = curves[panel.reference]
    return pd.DataFrame(columns).rename_axis("time (s)").reset_index()
