"""Waveforms at every receiver, with their residuals from the reference below on a separate scale:
every solution of a variant, or the variants of one engine as in the paper.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jointwave.cases.errors import require
from jointwave.compare.engines import ENGINES, in_order, label_of
from jointwave.compare.figures.export import SceneFigure, chart, set_heading
from jointwave.compare.figures.receivers import Panel, curve_table, in_rows, panels
from jointwave.compare.figures.style import (
    DRAWN,
    GIVEN,
    MOST_MARKS,
    PALE,
    RC,
    UNITS,
    printed,
    style,
    unit_for,
)
from jointwave.compare.misfit.pairs import A_COMPARISON, Comparison
from jointwave.compare.solvers.record import Line

#: Keys of a scene that do not change its physics.
ASIDE = {"title", "source", "name", "expect", "numerics", "record", "where"}
MOST = 6  # variants in one pair of axes
ROWS = 8  # most rows of axes in the first figure; the others are folded
HEIGHTS = [1.9, 0.7]  # inches of waveforms and of their residuals
NARROW = 3.3  # least width of a panel for two side by side, inches
THIN = 1.4  # largest line width of residuals, points
REFERENCE = "reference"
#: Colours of variants, light to dark: for up to four, then for up to six.
VARIANTS = (
    *("#9ad14b", "#e0559f", "#3b6fd4", "#1b0c3f"),
    *("#a5d65a", "#e68ab8", "#3f8fd6", "#b5432e", "#4b3fa8", "#000000"),
)
DOTS = Line("#000000", 0.9, 12, (0, (1.0, 2.0)))  # of references under variants

TITLE = "Waveforms at the receivers"
STYLES = (
    "Engines are wide and light, exact solutions dark and dashed over them, so that each is seen "
    "where several coincide."
)
BELOW = (
    "Below, on a separate scale, the difference from the reference. Stress is positive in "
    "compression; a static state is subtracted."
)


class Trace(NamedTuple):
    """A waveform, SI over time (s), and its residual from the reference, if it has one."""

    label: str
    style: Line
    curve: pd.Series
    residual: pd.Series | None = None


class Overlay(NamedTuple):
    """Waveforms of one quantity in one pair of axes.

    at_rest : the static state subtracted from them, SI. reference : of the residuals, its label.
    """

    heading: str
    quantity: str
    at_rest: float
    reference: str
    traces: list[Trace]


def waveforms(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figures of every variant's waveforms at every receiver, with external curves; the
    first has at most ROWS rows, the others are folded.

    Variants that differ by one key share axes, engine by engine, followed by all solutions of each
    variant; otherwise the first variant has its own figure.
    """
    overlaid, table = by_variant(comparisons), curve_table(comparisons)
    if not (rows := in_rows(comparisons)):
        return []
    solved = [[by_solution(panel) for panel in row] for row in rows]
    first = ROWS if overlaid else sum(row[0].variant == rows[0][0].variant for row in rows[:ROWS])
    key = f"Variants differ by {changed_key(comparisons)}; the first is wide and light, the last"
    variants = f"{key} thin and dark. Dotted: the reference. {BELOW}"
    every = f"{STYLES} {BELOW}"
    shown = solved if overlaid else solved[:first]
    title = f"{TITLE}, {rows[0][0].variant}" if len(comparisons) > 1 else TITLE
    title = "Waveforms of every solution, variant by variant" if overlaid else title
    parts = [
        ("variants", "Variants overlaid, engine by engine", variants, overlaid[:first]),
        ("variants-2", "Variants at the other receivers", variants, overlaid[first:]),
        ("waveforms", title, every, shown),
        ("waveforms-2", "Waveforms of the others", every, solved[len(shown) :]),
    ]
    return [
        SceneFigure(f"{name}-{stem}", title, caption, draw_overlays(grid), table, folded=k > 0)
        for k, (stem, title, caption, grid) in enumerate(part for part in parts if part[-1])
    ]


def figure(
    comparisons: Comparison | Sequence[Comparison], width: float = 190.0, font_size: float = 8.0
) -> Figure:
    """Return a figure for a paper of a scene's comparisons, one for each variant.

    width : mm. font_size : points.
    """
    given: Any = comparisons if isinstance(comparisons, list | tuple) else [comparisons]
    for one in given or [None]:
        require(one, Comparison, "figure", "type", A_COMPARISON)
    return draw_solutions([*given], False, printed(width, font_size))


def draw_solutions(
    comparisons: list[Comparison], residuals: bool = True, rc: dict[Any, Any] = RC
) -> Figure:
    """Return the figure of every solution of all variants; each variant starts a new row."""
    across = 2 if rc["figure.figsize"][0] > 2 * NARROW else 1
    grid = [[by_solution(panel) for panel in row] for row in in_rows(comparisons, across)]
    return draw_overlays(grid, residuals, rc)


def draw_overlays(
    grid: list[list[Overlay]], residuals: bool = True, rc: dict[Any, Any] = RC
) -> Figure:
    """Return the figure of overlays in rows; residuals : whether to draw them, in separate axes."""
    traces = [t for row in grid for overlay in row for t in overlay.traces]
    residuals = residuals and any(t.residual is not None for t in traces)
    heights, columns = HEIGHTS if residuals else HEIGHTS[:1], max(map(len, grid))
    with chart(len(grid), columns, heights, "time (ms)", rc) as (figure, axes):
        pairs = [
            (overlay, *axes[i, :, j]) for i, row in enumerate(grid) for j, overlay in enumerate(row)
        ]
        if len({overlay.quantity for overlay, *_ in pairs}) == 1:
            for _, upper, *_ in pairs[1:]:
                upper.sharey(pairs[0][1])
        for overlay, upper, *lower in pairs:
            draw_waveforms(upper, overlay)
            for ax in lower:
                _draw_residuals(ax, overlay)
    return figure


def draw_waveforms(ax: Axes, overlay: Overlay) -> None:
    """Draw an overlay into axes, without its residuals."""
    unit = DRAWN[UNITS[overlay.quantity]]
    # The static velocity is only a remainder of the relaxation.
    rests = overlay.at_rest and overlay.quantity != "velocity"
    rest = f"\nless {overlay.at_rest / unit.size:.4g} at rest" if rests else ""
    set_heading(ax, overlay.heading)
    ax.set_ylabel(f"{overlay.quantity} ({unit.name}){rest}")
    _plot(ax, unit.size, overlay.traces)


def _draw_residuals(ax: Axes, overlay: Overlay) -> None:
    found = [
        t._replace(curve=t.residual, style=t.style._replace(width=min(t.style.width, THIN)))
        for t in overlay.traces
        if t.residual is not None
    ]
    if found:
        largest, peak = (
            max(float(t.curve.abs().max()) for t in some) for some in (found, overlay.traces)
        )
        unit = unit_for(UNITS[overlay.quantity], largest)
        size = f", ≤ {100 * largest / peak:.2g}\u00a0% of the peak" if peak else ""
        set_heading(ax, f"less {overlay.reference} ({unit.name}){size}", small=True)
        ax.locator_params(axis="y", nbins=4)
        _plot(ax, unit.size, found)


def _plot(ax: Axes, size: float, traces: list[Trace]) -> None:
    ax.axhline(0, color=PALE, linewidth=0.4 * rcParams["lines.linewidth"], zorder=1)
    for label, drawn, curve, _ in traces:
        ax.plot(1e3 * curve.index.to_numpy(), curve / size, label=label, **drawn.of_line())


def by_solution(panel: Panel) -> Overlay:
    """Return the overlay of all solutions and external curves of one panel."""
    residuals = panel.residuals
    traces = [
        Trace(label_of(name), style(name), curve, residuals.get(name))
        for name, curve in panel.curves.items()
    ]
    for k, beside in enumerate(panel.comparison.besides):
        if (name := beside.curves.name) in panel.given:
            drawn = GIVEN[k % len(GIVEN)]
            drawn = drawn if len(beside.time) <= MOST_MARKS else drawn._replace(marker="")
            traces.append(Trace(name, drawn, panel.given[name] - panel.at_rest))
    about = panel.heading, panel.place.quantity, panel.at_rest, label_of(panel.reference)
    return Overlay(*about, traces)


def by_variant(comparisons: list[Comparison]) -> list[list[Overlay]]:
    """Return overlays of the variants, a column per engine and a row per receiver.

    Empty unless variants differ by exactly one key and share a panel.
    """
    if not 2 <= len(comparisons) <= MOST or changed_key(comparisons) is None:
        return []
    found = [{panel.place: panel for panel in row} for row in panels(comparisons)]
    shared = [place for place in found[0] if all(place in row for row in found)]
    solved = in_order(name for comparison in comparisons for name in comparison.results)
    engines = [name for name in solved if name in ENGINES]
    return [[_of_engine(one, [row[at] for row in found]) for one in engines] for at in shared]


def _of_engine(engine: str, row: list[Panel]) -> Overlay:
    """Return the overlay of an engine's waveforms in all variants, with dotted references."""
    traces, references = list[Trace](), list[tuple[str, Trace]]()
    for panel, drawn in zip(row, variant_styles(len(row)), strict=True):
        curves, known = panel.curves, panel.reference
        if engine in curves:
            traces.append(Trace(panel.variant, drawn, curves[engine], panel.residuals.get(engine)))
            if known != engine and known in curves:
                references.append((known, Trace(REFERENCE, DOTS, curves[known])))
    rest, place = {panel.at_rest for panel in row}, row[0].place
    at_rest = rest.pop() if len(rest) == 1 else 0.0
    several = len({name for name, _ in references}) != 1
    words = f"the {REFERENCE}" if several else label_of(references[0][0])
    traces += [dots for _, dots in references]
    return Overlay(f"{label_of(engine)}, {place.heading}", place.quantity, at_rest, words, traces)


def variant_styles(count: int) -> list[Line]:
    """Return the styles of overlaid variants, wide and light to thin and dark: all stay visible."""
    few = VARIANTS[:4] if count <= 4 else VARIANTS[4:]
    at = np.linspace(0, len(few) - 1, count).round().astype(int)
    widths = np.linspace(3.4, 1.0, count).round(2).tolist()
    return [Line(few[k], w, i) for i, (k, w) in enumerate(zip(at, widths, strict=True))]


def changed_key(comparisons: list[Comparison]) -> str | None:
    """Return the only key in which variants differ, such as "joints.damping_ratio", or None."""
    scenes = [comparison.scene.model_dump(exclude=ASIDE) for comparison in comparisons]
    keys = pd.json_normalize(scenes, max_level=1).map(repr)
    changed = keys.columns[keys.nunique() > 1]
    return str(changed[0]) if len(changed) == 1 else None
