"""Waveforms at every receiver over time: as in the paper, and all solutions of a variant."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from compare.figures.charts.chart import Chart, ChartLine, Entry, Subplot, solutions_legend
from compare.figures.figure import SceneFigure, chart_figure
from compare.figures.overlays import (
    REFERENCE,
    THIN,
    Overlay,
    by_solution,
    by_variant,
    changed_key,
    subplots_of,
)
from compare.figures.style import style
from compare.figures.subplots import UNITS, Panel, curve_table, in_page, panels
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

HEIGHT = 2.1  # inches of waveforms
TITLE = "Waveforms at the receivers"
STYLES = (
    "Engines are wide and light, exact solutions dark and dashed over them, so that each is seen "
    "where several coincide."
)
BELOW = "Below, on a separate scale, the difference from the reference."
POSITIVE = "Stress is positive in compression."

FEWEST = 3  # receivers
SHARE = 0.9  # amplitude of the largest waveform over the distance between two receivers


def waveforms(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the waveforms of every variant at every receiver, with external curves.

    Variants that differ by one key share one pair of axes per engine, followed by all solutions of
    each variant; many receivers of one variant are stacked.
    """
    receivers = [panel for row in panels(comparisons) for panel in row]
    ending = f"{POSITIVE}{_at_rest(receivers)}"
    overlaid = by_variant(comparisons)
    chart, title, caption = by_solutions(comparisons), TITLE, f"{STYLES} {BELOW} {ending}"
    if overlaid:
        title = "Waveforms of every solution, variant by variant"
    elif len(comparisons) == 1 and (stack := stacked(receivers, comparisons)):
        chart = stack
        caption = (
            "Each waveform is offset to the y of its receiver, with its difference from "
            f"the reference beside it. {STYLES} {ending}"
        )
    table = curve_table(comparisons).reset_index()
    found = chart_figure(f"{name}-waveforms", title, caption, chart, table, folded=bool(overlaid))
    return [_of_variants(name, comparisons, overlaid, receivers), found] if overlaid else [found]


def by_solutions(comparisons: list[Comparison]) -> Chart:
    """Return every solution of all variants.

    The curve of solution S in row i, column j is the part i-j-S, that of the k-th external file
    i-j-given-k, and the residual of S residual-i-j-S.
    """
    grid = [[by_solution(panel) for panel in row] for row in in_page(panels(comparisons))]
    return _chart(grid, solutions_legend(comparisons))


def by_variants(grid: list[list[Overlay]]) -> Chart:
    """Return the variants of every engine in one pair of axes each."""
    found = {t.name: t.style for row in grid for overlay in row for t in overlay.traces}
    in_order = sorted(found, key=lambda name: name == REFERENCE)  # last
    return _chart(grid, {"": [Entry(name, name, found[name]) for name in in_order]})


def _chart(grid: list[list[Overlay]], legend: dict[str, list[Entry]]) -> Chart:
    overlays = [overlay for row in grid for overlay in row]
    share = "waveforms" if len({overlay.label for overlay in overlays}) == 1 else ""
    depth = 2 if any(overlay.residuals for overlay in overlays) else 1
    cells = [
        [subplots_of(o, f"{i}-{j}", HEIGHT, share)[:depth] for j, o in enumerate(row)]
        for i, row in enumerate(grid)
    ]
    return Chart(cells, "time (ms)", legend, is_lettered=True)


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
    return chart_figure(f"{name}-variants", title, caption, by_variants(grid), table)


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


class Stack(NamedTuple):
    """Waveforms of one quantity, by y of the receiver (m) and solution, over time in s, SI.

    part : prefix of the parts of the SVG. widest : of a line, points.
    """

    quantity: str
    heading: str
    curves: dict[float, dict[str, pd.Series]]
    part: str
    widest: float = 9.0

    @property
    def largest(self) -> float:
        """The largest magnitude of all, SI."""
        every = [c for curves in self.curves.values() for c in curves.values()]
        return max((float(curve.abs().max()) for curve in every), default=0.0)

    @property
    def unit(self) -> Unit:
        """The unit of hover text."""
        return unit_for(UNITS[self.quantity], self.largest)

    @property
    def reach(self) -> float:
        """Amplitude of the largest magnitude on the ordinate, m."""
        return SHARE * float(np.diff(list(self.curves)).min())

    @property
    def label(self) -> str:
        """Label of the ordinate: the receivers' y, and the scale of waveforms."""
        if not self.largest:
            return "y (m)"
        size = self.largest / self.unit.size
        shown = max(x for x in (100, 50, 20, 10, 5, 2, 1) if x <= size)
        return f"y (m); {self.reach * shown / size:.2g} m represent {shown} {self.unit.name}"

    @property
    def subplot(self) -> Subplot:
        """The axes of the stack."""
        lines = [
            self._line(k, y, name, curve)
            for k, (y, curves) in enumerate(self.curves.items())
            for name, curve in curves.items()
        ]
        height, ticks = 1.0 + 0.75 * len(self.curves), list(self.curves)
        return Subplot(self.heading, self.label, lines, height, ticks=ticks, levels=tuple(ticks))

    def _line(self, k: int, y: float, name: str, curve: pd.Series) -> ChartLine:
        drawn = style(name)._replace(width=min(style(name).width, self.widest))
        scale = self.reach / self.largest if self.largest else 0.0
        place = f"{self.unit.name} at y = {y:g} m, %{{x:.2f}} ms"
        return ChartLine(
            name,
            drawn,
            1e3 * curve.index.values,
            y + scale * curve.values,
            f"%{{customdata:.4g}} {place}<extra>{name}</extra>",
            f"{self.part}-{k}-{name}",
            hovered=curve.values / self.unit.size,
        )


def stacked(panels: list[Panel], comparisons: list[Comparison]) -> Chart | None:
    """Return the waveforms of each quantity of one variant beside their residuals, as stacks.

    The curve of solution S at the k-th receiver of row i is the part i-k-S, its residual
    residual-i-k-S. None if a quantity has fewer than three receivers, each of which then has its
    own axes, if there are external data, and for a rock mass.
    """
    groups: dict[str, list[Panel]] = {}
    for panel in sorted(panels, key=lambda p: p.place.at):
        groups.setdefault(panel.place.named, []).append(panel)
    in_plane = any(len(panel.place.at) > 1 for panel in panels)
    few = any(len({p.place.at for p in group}) < FEWEST for group in groups.values())
    if comparisons[0].besides or few or in_plane:
        return None
    pairs = [stacks_of(words, group, i) for i, (words, group) in enumerate(groups.items())]
    grid = [[[waveforms.subplot], [residuals.subplot]] for waveforms, residuals in pairs]
    return Chart(grid, "time (ms)", solutions_legend(comparisons))


def stacks_of(words: str, group: list[Panel], row: int) -> tuple[Stack, Stack]:
    """Return the stacks of waveforms of one quantity and of their residuals."""
    quantity, reference = group[0].quantity, group[0].reference
    curves = {panel.place.at[0]: panel.curves for panel in group}
    left = {panel.place.at[0]: panel.residuals for panel in group}
    waveforms = Stack(quantity, words, curves, f"{row}")
    residuals = Stack(quantity, "", left, f"residual-{row}", THIN)
    if not residuals.largest:
        return waveforms, residuals
    share, times = residuals.largest / waveforms.largest, waveforms.largest / residuals.largest
    words = f"minus {reference}, enlarged {times:.2g} times: at most {100 * share:.2g} %"
    return waveforms, residuals._replace(heading=words)
