"""Waveforms at many receivers of one variant as an offset stack: the ordinate is y, with each
waveform at its receiver's y; beside them, magnified, the residuals from the reference.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from compare.figures.charts.chart import Chart, ChartLine, Subplot, solutions_legend
from compare.figures.overlays import THIN
from compare.figures.style import style
from compare.figures.subplots import UNITS, Panel
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

FEWEST = 3  # receivers
SHARE = 0.9  # amplitude of the largest waveform over the distance between two receivers


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
