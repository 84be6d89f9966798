"""Waveforms of many receivers of one pillar, each offset to its y, with their residuals beside."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from compare.figures.charts.axes import Legend, chart, set_heading
from compare.figures.charts.overlays import LEVEL, THIN
from compare.figures.panels import Panel
from compare.figures.style import style
from compare.figures.units import UNITS, unit_for

FEWEST = 3  # receivers
SHARE = 0.9  # amplitude of the largest waveform over the distance between two receivers

#: Waveforms in SI by y of the receiver (m) and by solution.
Curves = dict[float, dict[str, pd.Series]]


def stacks_of(panels: list[Panel]) -> list[list[Panel]]:
    """Return the panels of each quantity of one variant in the order of their y.

    Empty if a quantity has fewer than three receivers, each of which then has its own axes, if
    there are external data, and for a rock mass.
    """
    groups: dict[str, list[Panel]] = {}
    for panel in sorted(panels, key=lambda p: p.place.at):
        groups.setdefault(panel.place.named, []).append(panel)
    in_plane = any(len(panel.place.at) > 1 for panel in panels)
    few = any(len({p.place.at for p in group}) < FEWEST for group in groups.values())
    return [] if in_plane or few or panels[0].comparison.besides else list(groups.values())


def draw_stacks(stacks: list[list[Panel]], legend: Legend) -> Figure:
    """Return the figure: waveforms left, residuals right, a row for each quantity.

    The id of solution S at the k-th receiver of row i is i-k-S in the SVG, that of its residual
    residual-i-k-S.
    """
    height = 1.0 + 0.75 * max(map(len, stacks))
    with chart(legend, len(stacks), 2, [height], "time (ms)") as (figure, axes):
        for i, group in enumerate(stacks):
            curves = {panel.place.at[0]: panel.curves for panel in group}
            residuals = {panel.place.at[0]: panel.residuals for panel in group}
            left, right = axes[i, 0]
            set_heading(left, group[0].place.named)
            _draw(left, curves, group[0].quantity, f"{i}", np.inf)
            largest, rest = _largest(curves), _largest(residuals)
            if rest:
                words = f"minus {group[0].reference}, enlarged {largest / rest:.2g} times"
                set_heading(right, f"{words}: at most {100 * rest / largest:.2g} %")
                _draw(right, residuals, group[0].quantity, f"residual-{i}", THIN)
    return figure


def _largest(curves: Curves) -> float:
    return max((float(c.abs().max()) for of in curves.values() for c in of.values()), default=0.0)


def _draw(ax: Axes, curves: Curves, quantity: str, part: str, widest: float) -> None:
    """Draw curves on one scale, the largest nearly as high as two receivers are apart."""
    reach, largest = SHARE * float(np.diff(list(curves)).min()), _largest(curves)
    for k, (y, of_receiver) in enumerate(curves.items()):
        ax.axhline(y, color=LEVEL, linewidth=0.6, zorder=1)
        for name, curve in of_receiver.items():
            drawn = style(name)._replace(width=min(style(name).width, widest))
            offset = y + reach / (largest or 1.0) * curve
            ax.plot(1e3 * curve.index, offset, gid=f"{part}-{k}-{name}", **drawn.of_line())
    ax.set_yticks(list(curves))
    ax.set_ylabel(_label(quantity, reach, largest))


def _label(quantity: str, reach: float, largest: float) -> str:
    """Label the ordinate: the receivers' y, and the scale of waveforms."""
    if not largest:
        return "y (m)"
    unit = unit_for(UNITS[quantity], largest)
    size = largest / unit.size
    shown = max((x for x in (100, 50, 20, 10, 5, 2, 1) if x <= size), default=size)
    return f"y (m); {reach * shown / size:.2g} m represent {shown:g} {unit.name}"
