"""Waveforms in one pair of axes, and below them their residuals from the reference on a separate
scale: by solution in one variant, or by variant of one engine.
"""

from itertools import cycle
from string import ascii_lowercase
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, in_order
from jointwave.compare.figures.charts.axes import Legend, chart, set_heading, share
from jointwave.compare.figures.panels import Panel, panels
from jointwave.compare.figures.style import Style, given_style, style
from jointwave.compare.figures.units import DRAWN, UNITS, unit_for
from jointwave.compare.misfit.pairs import Comparison

#: Keys of a scene that do not change its physics, or only its numerical solution.
ASIDE = {"title", "source", "name", "expect", "numerics", "record", "where"}
MOST = 6  # variants in one pair of axes
HEIGHTS = [2.1, 0.75]  # inches of waveforms and of their residuals
THIN = 1.4  # points, the widest line of residuals
LEVEL = "#bbbbbb"  # of zero
REFERENCE = "reference"
#: Colours of variants, light to dark: of up to four, then of up to six.
VARIANTS = (
    *("#9ad14b", "#e0559f", "#3b6fd4", "#1b0c3f"),
    *("#a5d65a", "#e68ab8", "#3f8fd6", "#b5432e", "#4b3fa8", "#000000"),
)
DOTS = Style("#000000", 0.9, (0, (1.0, 2.0)), 12)  # of references under variants


class Trace(NamedTuple):
    """A waveform over time (s), SI, and its residual from the reference (None without one).

    name : its entry in the legend. part : of its id in the SVG. marker : of its samples, if few.
    """

    name: str
    style: Style
    curve: pd.Series
    residual: pd.Series | None = None
    part: str = ""
    marker: str = ""


class Overlay(NamedTuple):
    """Waveforms of one quantity at one place. at_rest : SI, the static state subtracted from them.

    reference : of the residuals, in words.
    """

    heading: str
    quantity: str
    at_rest: float
    traces: list[Trace]
    reference: str

    @property
    def label(self) -> str:
        """Label of the ordinate, with the static state that is not drawn; a velocity has none but
        the remainder of its relaxation."""
        unit, rests = DRAWN[UNITS[self.quantity]], self.at_rest and self.quantity != "velocity"
        rest = f"\nless {self.at_rest / unit.size:.4g} at rest" if rests else ""
        return f"{self.quantity} ({unit.name}){rest}"

    @property
    def residuals(self) -> dict[str, pd.Series]:
        """The residuals by the part of their trace."""
        return {t.part: t.residual for t in self.traces if t.residual is not None}


def draw_overlays(grid: list[list[Overlay]], legend: Legend) -> Figure:
    """Return the figure of overlays in rows.

    The id of trace T in row i, column j is i-j-T in the SVG, that of its residual residual-i-j-T.
    """
    every = [overlay for row in grid for overlay in row]
    heights = HEIGHTS if any(overlay.residuals for overlay in every) else HEIGHTS[:1]
    columns, alike = max(map(len, grid)), len({overlay.label for overlay in every}) == 1
    with chart(legend, len(grid), columns, heights, "time (ms)") as (figure, axes):
        if alike:
            share(axes[:, 0].flat)
        letters = cycle(f"({letter})  " for letter in ascii_lowercase)
        for i, row in enumerate(grid):
            for j, overlay in enumerate(row):
                upper, *lower = axes[i, :, j]
                set_heading(upper, f"{next(letters)}{overlay.heading}")
                if j == 0 or not alike:
                    upper.set_ylabel(overlay.label)
                _draw_waveforms(upper, overlay, f"{i}-{j}")
                if overlay.residuals:
                    _draw_residuals(lower[0], overlay, f"{i}-{j}")
    return figure


def _draw_waveforms(ax: Axes, overlay: Overlay, place: str) -> None:
    unit = DRAWN[UNITS[overlay.quantity]]
    ax.axhline(0, color=LEVEL, linewidth=0.6, zorder=1)
    for t in overlay.traces:
        time, values = 1e3 * t.curve.index.to_numpy(), t.curve / unit.size
        ax.plot(time, values, gid=f"{place}-{t.part}", **t.style.of_line(t.marker))


def _draw_residuals(ax: Axes, overlay: Overlay, place: str) -> None:
    residuals = overlay.residuals
    largest = max(float(r.abs().max()) for r in residuals.values())
    peak = max(float(t.curve.abs().max()) for t in overlay.traces)
    unit = unit_for(UNITS[overlay.quantity], largest)
    size = f", at most {100 * largest / peak:.2g}\u00a0% of the peak" if peak else ""
    set_heading(ax, f"less {overlay.reference} ({unit.name}){size}", small=True)
    ax.axhline(0, color=LEVEL, linewidth=0.6, zorder=1)
    ax.locator_params(axis="y", nbins=4)
    for t in overlay.traces:
        if (rest := residuals.get(t.part)) is not None:
            thin = t.style._replace(width=min(t.style.width, THIN))
            time, gid = 1e3 * rest.index.to_numpy(), f"residual-{place}-{t.part}"
            ax.plot(time, rest / unit.size, gid=gid, **thin.of_line())


def by_solution(panel: Panel) -> Overlay:
    """Return every solution of one variant at one receiver."""
    residuals, given = panel.residuals, panel.given
    traces = [Trace(n, style(n), c, residuals.get(n), n) for n, c in panel.curves.items()]
    for k, beside in enumerate(panel.comparison.besides):
        if (name := beside.curves.name) in given:
            drawn, marker = given_style(k, len(beside.time))
            traces.append(Trace(name, drawn, given[name], None, f"given-{k}", marker))
    heading = f"{panel.heading}, {panel.variant}"
    return Overlay(heading, panel.quantity, panel.at_rest, traces, panel.reference)


def by_variant(comparisons: list[Comparison]) -> list[list[Overlay]]:
    """Return the variants of each engine in one pair of axes, engines across and receivers down.

    Empty if variants differ by more than one key, in their receivers, or in the largest component.
    """
    if not 2 <= len(comparisons) <= MOST or changed_key(comparisons) is None:
        return []
    rows = [list(row) for row in zip(*panels(comparisons), strict=False)]
    if any(len({p.place for p in row}) > 1 for row in rows):
        return []
    solved = in_order(name for comparison in comparisons for name in comparison.results)
    return [[_of_engine(one, row) for one in solved if one in ENGINES] for row in rows]


def _of_engine(engine: str, row: list[Panel]) -> Overlay:
    """Return an engine's waveform in every variant, and the reference of each as dots."""
    styles = variant_styles(len(row))
    traces, references = [], set[str]()
    for k, (panel, drawn) in enumerate(zip(row, styles, strict=True)):
        curves, known = panel.curves, panel.reference
        if engine not in curves:
            continue
        residual = panel.residuals.get(engine)
        traces.append(Trace(panel.variant, drawn, curves[engine], residual, f"variant-{k}"))
        if known != engine and known in curves:
            references.add(known)
            traces.append(Trace(REFERENCE, DOTS, curves[known], None, f"reference-{k}"))
    rest = {panel.at_rest for panel in row}
    at_rest = rest.pop() if len(rest) == 1 else 0.0
    known = references.pop() if len(references) == 1 else f"the {REFERENCE}"
    return Overlay(f"{engine}, {row[0].heading}", row[0].quantity, at_rest, traces, known)


def variant_styles(count: int) -> list[Style]:
    """Return the styles of superposed variants: the first wide and light, the last thin and dark,
    so that each is visible where they coincide."""
    few = VARIANTS[:4] if count <= 4 else VARIANTS[4:]
    at = np.linspace(0, len(few) - 1, count).round().astype(int)
    widths = np.linspace(3.4, 1.0, count).round(2).tolist()
    return [Style(few[k], w, "-", i) for i, (k, w) in enumerate(zip(at, widths, strict=True))]


def changed_key(comparisons: list[Comparison]) -> str | None:
    """Return the one key in which the variants of a scene differ, "joints.damping_ratio"; None if
    they differ in none or in several."""
    base, *variants = (_flat(comparison.scene) for comparison in comparisons)
    changed = {k for v in variants for k in base.keys() | v.keys() if base.get(k) != v.get(k)}
    return changed.pop() if len(changed) == 1 else None


def _flat(scene: AnyScene) -> dict[str, object]:
    """Return everything that determines a scene's physics, by dotted key."""
    found: dict[str, object] = {}
    for name, value in scene.model_dump(exclude=ASIDE).items():
        if isinstance(value, dict):
            found |= {f"{name}.{key}": part for key, part in value.items()}
        else:
            found[name] = value
    return found
