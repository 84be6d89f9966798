"""Waveforms in one pair of axes, and below them their residuals from the reference on a separate
scale: by solution in one variant, or by variant of one engine.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from cases.kinds import AnyScene
from compare.engines import ENGINES
from compare.figures.charts.chart import ChartLine, Subplot
from compare.figures.style import Style, given_style, in_order, style
from compare.figures.subplots import UNITS as SI
from compare.figures.subplots import Panel, panels
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

#: Factor from SI to the drawn unit, and that unit.
DRAWN = {"Pa": (1e-6, "MPa"), "m/s": (1.0, "m/s"), "m": (1e3, "mm"), "rad": (1e3, "mrad")}
UNITS = {quantity: DRAWN[unit] for quantity, unit in SI.items()}
#: Keys of a scene that do not change its physics, or only its numerical solution.
ASIDE = {"title", "source", "name", "expect", "numerics", "record", "where"}
MOST = 6  # variants in one pair of axes
RESIDUAL = 0.75  # inches of residuals in print
THIN = 1.4  # points, the widest line of residuals
REFERENCE = "reference"
#: Colours of variants, light to dark: of up to four, then of up to six.
VARIANTS = (
    *("#9ad14b", "#e0559f", "#3b6fd4", "#1b0c3f"),
    *("#a5d65a", "#e68ab8", "#3f8fd6", "#b5432e", "#4b3fa8", "#000000"),
)
DOTS = Style("#000000", 0.9, (0, (1.0, 2.0)), 12)  # of references under variants


class Trace(NamedTuple):
    """A waveform over time (s), SI, and its residual from the reference (None without one).

    name : its entry in the legend. part : of the SVG. marker : of its samples, if few.
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
        """Label of the ordinate, with the static state that is not drawn."""
        factor, unit = UNITS[self.quantity]
        rest = f"\nless {factor * self.at_rest:.4g} at rest" if self.at_rest else ""
        return f"{self.quantity} ({unit}){rest}"

    @property
    def residuals(self) -> list[Trace]:
        """The traces with a residual."""
        return [trace for trace in self.traces if trace.residual is not None]

    @property
    def unit(self) -> Unit:
        """The unit of drawn residuals."""
        return unit_for(SI[self.quantity], self._largest)

    @property
    def _largest(self) -> float:
        residuals = (t.residual for t in self.traces)
        return max((float(np.abs(r).max()) for r in residuals if r is not None), default=0.0)

    @property
    def residual_heading(self) -> str:
        """Heading of the residuals, with their size relative to the waveforms."""
        if not self.residuals:
            return "no reference solution"
        peak = max(float(t.curve.abs().max()) for t in self.traces)
        share = f", at most {100 * self._largest / peak:.2g}\u00a0% of the peak" if peak else ""
        return f"less {self.reference} ({self.unit.name}){share}"


def subplots_of(overlay: Overlay, place: str, height: float, share: str) -> list[Subplot]:
    """Return the axes of an overlay's waveforms, and below them those of its residuals.

    place : in the names of the lines' parts ("0-1"). share : see `Subplot`.
    """
    factor, name = UNITS[overlay.quantity]
    waveforms = [
        _line(t, factor * t.curve, name, f"{place}-{t.part}", t.style) for t in overlay.traces
    ]
    residuals = [
        _line(
            t,
            t.residual / overlay.unit.size,
            overlay.unit.name,
            f"residual-{place}-{t.part}",
            t.style._replace(width=min(t.style.width, THIN)),
        )
        for t in overlay.traces
        if t.residual is not None
    ]
    lower = Subplot(overlay.residual_heading, "", residuals, RESIDUAL, levels=(0,), is_minor=True)
    return [
        Subplot(overlay.heading, overlay.label, waveforms, height, share, levels=(0,)),
        lower if residuals else lower._replace(ticks=[]),
    ]


def _line(trace: Trace, curve: pd.Series, unit: str, part: str, style: Style) -> ChartLine:
    hover = f"%{{y:.4g}} {unit} at %{{x:.2f}} ms<extra>{trace.name}</extra>"
    time = 1e3 * curve.index.values
    return ChartLine(trace.name, style, time, curve.values, hover, part, trace.marker)


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
    solved = in_order({name for comparison in comparisons for name in comparison.results})
    return [[_of_engine(one, row) for one in solved if one in ENGINES] for row in rows]


def changed_key(comparisons: list[Comparison]) -> str | None:
    """Return the one key in which the variants of a scene differ, "joints.damping_ratio"; None if
    they differ in none or in several."""
    base, *variants = (_flat(comparison.scene) for comparison in comparisons)
    changed = {k for v in variants for k in base.keys() | v.keys() if base.get(k) != v.get(k)}
    return changed.pop() if len(changed) == 1 else None


def variant_styles(count: int) -> list[Style]:
    """Return the styles of superposed variants: the first wide and light, the last thin and dark,
    so that each is visible where they coincide."""
    few = VARIANTS[:4] if count <= 4 else VARIANTS[4:]
    at = np.linspace(0, len(few) - 1, count).round().astype(int)
    widths = np.linspace(3.4, 1.0, count).round(2).tolist()
    return [Style(few[k], w, "-", i) for i, (k, w) in enumerate(zip(at, widths, strict=True))]


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


def _flat(scene: AnyScene) -> dict[str, object]:
    """Return everything that determines a scene's physics, by dotted key."""
    found: dict[str, object] = {}
    for name, value in scene.model_dump(exclude=ASIDE).items():
        if isinstance(value, dict):
            found |= {f"{name}.{key}": part for key, part in value.items()}
        else:
            found[name] = value
    return found
