"""Bands of an ensemble's waveforms: the median and the 5th to 95th percentile at every time."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from jointwave.compare.engines import in_order, label_of
from jointwave.compare.figures.export import chart, set_heading
from jointwave.compare.figures.style import UNITS, style
from jointwave.compare.misfit.places import Place, waveforms

SEEN = ("stress", "velocity", "traction", "gap", "slip")  # quantities drawn
MOST, ACROSS, HEIGHT = 12, 2, 1.6  # most waveforms, number side by side, height of each in inches
FAINT = 1e-6  # of the largest waveform of its quantity; smaller waveforms are round-off


def draw(results: dict[str, xr.Dataset]) -> Figure | None:
    """Return the bands of at most MOST waveforms that exceed round-off; None if there are none.

    results : mean and percentiles of every waveform by solver, `statistic` as first dimension.
    """
    every: dict[Place, dict[str, list[np.ndarray]]] = {}
    for name in in_order(results):
        waves = [waveforms(results[name].sel(statistic=q)) for q in ("p5", "p50", "p95")]
        for place in (one for one in waves[1] if one.quantity in SEEN):
            every.setdefault(place, {})[name] = [one[place] for one in waves]
    sizes = {at: max(float(abs(w[1]).max()) for w in found.values()) for at, found in every.items()}
    loudest = {q: max((sizes[p] for p in sizes if p.quantity == q), default=0.0) for q in SEEN}
    seen = [at for at in every if sizes[at] > FAINT * loudest[at.quantity]][:MOST]
    if not seen:
        return None
    across = min(ACROSS, len(seen))
    with chart(-(-len(seen) // across), across, [HEIGHT], "time (ms)") as (figure, axes):
        for ax, place in zip(axes.flat, seen, strict=False):
            for name, (low, middle, high) in every[place].items():
                look, ms = style(name), 1e3 * results[name].time.values
                shade: dict[str, Any] = {"color": look.colour, "alpha": 0.2, "linewidth": 0}
                ax.fill_between(ms, low, high, zorder=1 + look.order, **shade)
                ax.plot(ms, middle, label=label_of(name), **look._replace(width=1.3).of_line())
            set_heading(ax, place.heading)
            ax.set_ylabel(UNITS[place.quantity])
    return figure
