"""The figure of a fit: each waveform as measured and as fitted, and its residual."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from compare.experiments.fit.result import Fit, Fitted
from compare.figures.blank import blank
from compare.figures.overlays import UNITS
from compare.figures.style import GIVEN, style

WIDTH, PANEL, AROUND = 7.5, 2.6, 0.8  # inches: the figure, a waveform with its residual, the rest
MOST_MARKS = 250  # samples that are drawn one by one


def draw(found: Fit) -> Figure:
    """Return the figure: each waveform as measured and fitted, and below it what is left."""
    count = len(found.waveforms)
    with blank(AROUND + count * PANEL, WIDTH) as figure:
        axes = figure.subplots(2 * count, sharex=True, height_ratios=[3, 1] * count, squeeze=False)
        for i, one in enumerate(found.waveforms):
            _draw_waveform(axes[2 * i, 0], axes[2 * i + 1, 0], one, found.solver, i)
        figure.align_ylabels()
        axes[-1, 0].set_xlabel("time (ms)")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside upper center", ncols=len(handles), frameon=False
        )
    return figure


def _draw_waveform(wave: Any, left: Any, one: Fitted, solver: str, i: int) -> None:
    place: Any = one.place
    factor, unit = UNITS[place.quantity]
    few = len(one.time) <= MOST_MARKS
    points = {"linestyle": "none", "marker": "o", "markersize": 2.0, "color": GIVEN[0].colour}
    line = {"color": style(solver).colour, "linewidth": 1.6, "linestyle": "-"}
    given = points if few else GIVEN[0].of_line()
    time = 1e3 * one.time
    wave.plot(time, factor * one.fitted, label=f"fitted ({solver})", zorder=2, **line)
    wave.plot(time, factor * one.measured, label="measured", **{**given, "zorder": 3})
    left.plot(time, factor * (one.measured - one.fitted), color=GIVEN[0].colour, linewidth=0.8)
    left.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=1)
    shown = one.name if len(one.name) <= 28 else f"{one.name[:12]}…{one.name[-15:]}"
    where = place.heading
    misfit = f"misfit {one.before:.2%} before, {one.after:.2%} after"
    title = f"({chr(97 + i % 26)})  {where}, {shown}: {misfit}"
    wave.set_title(title.replace("$", r"\$"), pad=4)
    wave.set_ylabel(f"{place.quantity} ({unit})")
    left.set_ylabel(f"residual\n({unit})")
    reach = factor * float(np.abs(one.measured - one.fitted).max()) or 1.0
    left.set_ylim(-1.15 * reach, 1.15 * reach)
    for ax in (wave, left):
        ax.margins(x=0)
