"""Waveforms at every receiver over time: as the paper has them, and every solution of a variant."""

from typing import Any

import pandas as pd

from compare.figures.charts import interactive
from compare.figures.charts.offset_stack import draw_stacks, plot_stacks, stacks_of
from compare.figures.figure import Picture
from compare.figures.overlay_figures import draw, draw_variants
from compare.figures.overlays import Overlay, by_solution, by_variant, changed_key, legend_of
from compare.figures.style import GIVEN, Style, in_order, style
from compare.figures.subplots import UNITS, Panel, curve_table, panels
from compare.misfit.pairs import Comparison

MOST = 1200  # samples of an interactive curve
UPPER, LOWER = 190, 76  # px of waveforms and of their residuals
LOOKS = (
    "Engines are wide and light, exact solutions dark and dashed over them, so that each is seen "
    "where several coincide."
)
BELOW = "Below, on a scale of its own, what each leaves from the reference."
POSITIVE = "Stress is positive in compression."


def waveforms(name: str, comparisons: list[Comparison]) -> list[Picture]:
    """Return the waveforms of every variant at every receiver, and curves of others beside them.

    Variants that differ by one key stand in one pair of axes an engine, and all solutions of each
    variant after that; many receivers of one variant are stacked.
    """
    overlaid = by_variant(comparisons)
    if overlaid:
        return [_of_variants(name, comparisons, overlaid), _of_solutions(name, comparisons, True)]
    shown = [panel for row in panels(comparisons) for panel in row]
    stacks = stacks_of(shown) if len(comparisons) == 1 and not comparisons[0].besides else []
    if not stacks:
        return [_of_solutions(name, comparisons, False)]
    looks = looks_of(comparisons)
    return [
        Picture(
            f"{name}-waveforms",
            "waveforms",
            "Waveforms at the receivers",
            f"Each waveform stands on the y of its receiver, and beside them what each leaves from "
            f"the reference. {LOOKS} {POSITIVE}{_at_rest(shown)}",
            draw_stacks(f"{name}-waveforms", stacks),
            curve_table(comparisons).reset_index(),
            plot_stacks(stacks, looks),
        )
    ]


def _of_variants(name: str, comparisons: list[Comparison], grid: list[list[Overlay]]) -> Picture:
    overlays = [overlay for row in grid for overlay in row]
    shown = [panel for row in panels(comparisons) for panel in row]
    return Picture(
        f"{name}-variants",
        "waveforms",
        "Variants in one pair of axes, engine by engine",
        f"Variants differ by {changed_key(comparisons)}; the first is wide and light, the last "
        f"thin and dark. Dotted: the reference, {_references(shown)}. {BELOW} {POSITIVE}"
        f"{_at_rest(shown)}",
        draw_variants(f"{name}-variants", grid),
        _variant_table(overlays, shown),
        _plot(overlays, legend_of(overlays)),
    )


def _of_solutions(name: str, comparisons: list[Comparison], folded: bool) -> Picture:
    shown = [panel for row in panels(comparisons) for panel in row]
    return Picture(
        f"{name}-waveforms",
        "waveforms",
        "Waveforms of every solution, variant by variant"
        if folded
        else "Waveforms at the receivers",
        f"{LOOKS} {BELOW} {POSITIVE}{_at_rest(shown)}",
        draw(f"{name}-waveforms", comparisons),
        curve_table(comparisons).reset_index(),
        _plot([by_solution(panel) for panel in shown], looks_of(comparisons)),
        folded,
    )


def _references(shown: list[Panel]) -> str:
    """Say what every variant is held against."""
    found: dict[str, list[str]] = {}
    for panel in shown:
        found.setdefault(panel.reference, []).append(panel.variant)
    if len(found) == 1:
        return next(iter(found))
    return ", ".join(f"{name} ({', '.join(dict.fromkeys(v))})" for name, v in found.items())


def _at_rest(shown: list[Panel]) -> str:
    """Say what static state was taken from the waveforms; nothing where they had none."""
    if not any(panel.at_rest for panel in shown):
        return ""
    states = dict.fromkeys(
        f"{panel.at_rest:.4g} {UNITS[panel.quantity]} ({panel.place}, {panel.variant})"
        for panel in shown
        if panel.at_rest
    )
    return f" Drawn is the motion, less the static state: {'; '.join(states)}."


def _variant_table(overlays: list[Overlay], shown: list[Panel]) -> pd.DataFrame:
    """Return curves of engines and what they are held against, SI: time first, a column each."""
    columns: dict[str, pd.Series] = {}
    for overlay in overlays:
        for trace in overlay.traces:
            if trace.part.startswith("variant"):
                name = f"{overlay.heading} | {trace.name} ({UNITS[overlay.quantity]})"
                columns[name] = trace.curve
    for panel in shown:
        if panel.reference in (curves := panel.curves):
            name = f"{panel.reference}, {panel.place} | {panel.variant} ({UNITS[panel.quantity]})"
            columns[name] = curves[panel.reference]
    return pd.DataFrame(columns).rename_axis("time (s)").reset_index()


def _plot(overlays: list[Overlay], looks: dict[str, Style]) -> dict[str, Any]:
    """Return the interactive figure: overlays one under the other, each entry of the legend
    switched in all at once."""
    labels = {overlay.label for overlay in overlays}
    rows: list[interactive.Panel] = []
    traces = []
    for overlay in overlays:
        alike = {"matches": "y"} if len(labels) == 1 and rows else None
        label = overlay.label.replace("\n", "<br>")
        traces += [_trace(t.curve, t.name, t.look, overlay, len(rows)) for t in overlay.traces]
        rows.append(interactive.Panel(overlay.heading, label, UPPER, alike))
        if overlay.residuals:
            traces += [_rest(t, overlay, len(rows)) for t in overlay.residuals]
            rows.append(interactive.Panel(overlay.residual_heading, "", LOWER, {"nticks": 4}))
    layout = interactive.layout(rows, {"title": {"text": "time (ms)"}}, len(looks))
    return {"data": interactive.in_layers(traces, looks), "layout": layout}


def looks_of(comparisons: list[Comparison], given: bool = True) -> dict[str, Style]:
    """Return how the results of the variants and, with `given`, the curves of others are drawn, in
    the order of the legend."""
    names = {name for comparison in comparisons for name in comparison.results}
    files = [beside.curves.name for beside in comparisons[0].besides] if given else []
    return {name: style(name) for name in in_order(names)} | {
        file: GIVEN[k % len(GIVEN)] for k, file in enumerate(files)
    }


def _rest(trace: Any, overlay: Overlay, row: int) -> dict[str, Any]:
    """Return what a waveform leaves from its reference, in the unit of the residuals."""
    look = trace.look._replace(width=min(trace.look.width, 1.4))
    unit = overlay.unit
    return _line(trace.residual / unit.size, trace.name, look, unit.name, row)


def _trace(curve: pd.Series, name: str, look: Style, overlay: Overlay, row: int) -> dict[str, Any]:
    return _line(overlay.factor * curve, name, look, overlay.unit_name, row)


def _line(curve: pd.Series, name: str, look: Style, unit: str, row: int) -> dict[str, Any]:
    kept = curve.iloc[interactive.thinned(len(curve), MOST)]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        **interactive.places("x", 1e3 * kept.index.values),
        "y": interactive.packed(kept.values),
        "yaxis": interactive.axis_of(row),
        "line": interactive.line(look),
        "hovertemplate": f"%{{y:.4g}} {unit} at %{{x:.2f}} ms<extra>{name}</extra>",
    }
