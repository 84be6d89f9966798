"""Waveforms at many receivers of one variant as an offset stack: the ordinate is y, and on each
receiver's y stands its waveform; beside it, larger, what each leaves from its reference.
"""

from typing import Any, NamedTuple

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from compare.figures.charts import interactive
from compare.figures.overlay_figures import THIN, add_legend
from compare.figures.style import RC, WIDTH, Style, style
from compare.figures.subplots import UNITS, Panel
from compare.figures.units import Unit, unit_for

FEWEST = 3  # receivers
SHARE = 0.9  # of the room between two receivers, that the largest waveform takes
MOST = 1200  # samples of an interactive curve


class Stack(NamedTuple):
    """Waveforms of one quantity, by y of the receiver (m) and solution, over time in s, SI.

    widest : points, of a line.
    """

    quantity: str
    heading: str
    curves: dict[float, dict[str, pd.Series]]
    widest: float = 9.0

    @property
    def largest(self) -> float:
        """The largest magnitude of all, SI."""
        every = [c for curves in self.curves.values() for c in curves.values()]
        return max((float(curve.abs().max()) for curve in every), default=0.0)

    @property
    def unit(self) -> Unit:
        """What they are told in."""
        return unit_for(UNITS[self.quantity], self.largest)

    @property
    def room(self) -> float:
        """Metres of the ordinate that the largest magnitude takes."""
        return SHARE * float(np.diff(list(self.curves)).min())

    @property
    def label(self) -> str:
        """Of the ordinate: the receivers' y, and how large a waveform is drawn."""
        if not self.largest:
            return "y (m)"
        size = self.largest / self.unit.size
        shown = max(x for x in (100, 50, 20, 10, 5, 2, 1) if x <= size)
        return f"y (m); {self.room * shown / size:.2g} m stand for {shown} {self.unit.name}"

    def placed(self, y: float, curve: pd.Series) -> np.ndarray:
        """Return a waveform as it stands on the ordinate, m."""
        return y + (self.room / self.largest if self.largest else 0.0) * curve.values


def stacks_of(panels: list[Panel]) -> list[tuple[Stack, Stack]]:
    """Return the waveforms of each quantity of one variant and their residuals, as stacks.

    Empty where a quantity has fewer than three receivers: each then has a panel of its own.
    """
    groups: dict[str, list[Panel]] = {}
    for panel in sorted(panels, key=lambda p: p.y):
        groups.setdefault(f"{panel.quantity} {panel.axis}".rstrip(), []).append(panel)
    if any(len({p.y for p in group}) < FEWEST for group in groups.values()):
        return []
    return [_stacks(words, group) for words, group in groups.items()]


def _stacks(words: str, group: list[Panel]) -> tuple[Stack, Stack]:
    quantity, reference = group[0].quantity, group[0].reference
    waveforms = Stack(quantity, words, {p.y: p.curves for p in group})
    rest = Stack(quantity, "", {p.y: p.residuals for p in group}, THIN)
    if not rest.largest:
        return waveforms, rest
    share, times = rest.largest / waveforms.largest, waveforms.largest / rest.largest
    words = f"less {reference}, drawn {times:.2g} times as large: at most {100 * share:.2g} %"
    return waveforms, rest._replace(heading=words)


def draw_stacks(name: str, found: list[tuple[Stack, Stack]]) -> Figure:
    """Return the figure: a row a quantity, waveforms on the left and residuals on the right.

    The curve of solution S at the k-th receiver of row i is the SVG group NAME-i-k-S, its residual
    NAME-residual-i-k-S.
    """
    with matplotlib.rc_context(RC):
        height = 1.0 + sum(1.2 + 0.75 * len(waveforms.curves) for waveforms, _ in found)
        figure = Figure(figsize=(WIDTH, height))
        FigureCanvasAgg(figure)
        axes = figure.subplots(len(found), 2, squeeze=False, sharex=True, sharey="row")
        for i, (waveforms, rest) in enumerate(found):
            _draw(axes[i, 0], waveforms, f"{name}-{i}")
            _draw(axes[i, 1], rest, f"{name}-residual-{i}")
        for ax in axes[-1]:
            ax.set_xlabel("time (ms)")
        names = {n for stack, _ in found for curves in stack.curves.values() for n in curves}
        add_legend(figure, names, [])
    return figure


def _draw(ax: Axes, stack: Stack, gid: str) -> None:
    for k, (y, curves) in enumerate(stack.curves.items()):
        ax.axhline(y, color="#bbbbbb", linewidth=0.6, zorder=1)
        for name, curve in curves.items():
            look = style(name)._replace(width=min(style(name).width, stack.widest)).of_line()
            (line,) = ax.plot(1e3 * curve.index, stack.placed(y, curve), **look)
            line.set_gid(f"{gid}-{k}-{name}")
    ax.set_title(stack.heading, pad=4)
    ax.set_ylabel(stack.label)
    ax.tick_params(labelleft=True)
    ax.set_yticks(list(stack.curves))
    ax.margins(x=0, y=0.02)


def plot_stacks(found: list[tuple[Stack, Stack]], looks: dict[str, Style]) -> dict[str, Any]:
    """Return the interactive figure: under each quantity's waveforms their residuals."""
    stacks = [stack for pair in found for stack in pair]
    rows = [
        interactive.Panel(
            s.heading,
            s.label,
            90 + 60 * len(s.curves),
            {"tickvals": list(s.curves)},
        )
        for s in stacks
    ]
    traces = [
        _trace(name, y, curve, stack, (i, looks[name]))
        for i, stack in enumerate(stacks)
        for y, curves in stack.curves.items()
        for name, curve in curves.items()
    ]
    layout = interactive.layout(rows, {"title": {"text": "time (ms)"}}, len(looks))
    return {"data": interactive.in_layers(traces, looks), "layout": layout}


def _trace(
    name: str, y: float, curve: pd.Series, stack: Stack, drawn: tuple[int, Style]
) -> dict[str, Any]:
    row, look = drawn
    kept = curve.iloc[interactive.thinned(len(curve), MOST)]
    place = f"{stack.unit.name} at y = {y:g} m, %{{x:.2f}} ms"
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "legendgroup": name,
        **interactive.places("x", 1e3 * kept.index.values),
        "y": interactive.packed(stack.placed(y, kept)),
        "customdata": interactive.packed(kept.values / stack.unit.size),
        "yaxis": interactive.axis_of(row),
        "line": interactive.line(look._replace(width=min(look.width, stack.widest))),
        "hovertemplate": f"%{{customdata:.4g}} {place}<extra>{name}</extra>",
    }
