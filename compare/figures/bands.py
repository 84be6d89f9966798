"""Bands of an ensemble's waveforms: the median of all members, and from the 5th to the 95th
percentile at every time."""

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from jointwave.compare.engines import in_order, label_of
from jointwave.compare.figures.charts.axes import chart, set_heading
from jointwave.compare.figures.style import style
from jointwave.compare.figures.units import UNITS
from jointwave.compare.misfit.places import Place, places_of

SEEN = ("stress", "velocity", "traction", "gap", "slip")  # of a result
MOST, ACROSS, HEIGHT = 12, 2, 1.6  # waveforms drawn, side by side, and inches of each
FAINT = 1e-6  # of the largest of its quantity: a waveform of round-off
LOW, MIDDLE, HIGH = PERCENTILES = "p5", "p50", "p95"
TITLE = "Waveforms of an ensemble: median and 5 to 95 % of its members"

#: PERCENTILES over time (s), SI, by the place of the waveform and the name of the solver.
Bands = dict[Place, dict[str, pd.DataFrame]]


def bands_of(results: dict[str, xr.Dataset]) -> Bands:
    """Return the bands of at most MOST waveforms, those that exceed round-off.

    results : mean and percentiles of every waveform by the name of the solver, with `statistic` as
    their first dimension.
    """
    found: Bands = {}
    for name in in_order(results):
        by_percentile = {q: results[name].sel(statistic=q) for q in PERCENTILES}
        for quantity in (one for one in SEEN if one in results[name]):
            at, components = places_of(by_percentile[MIDDLE], quantity)
            least = FAINT * float(abs(by_percentile[MIDDLE][quantity]).max())
            for place in (Place(quantity, part, one) for one in at for part in components):
                waves = {q: place.waveform(one) for q, one in by_percentile.items()}
                frame = pd.DataFrame(waves, np.round(results[name].time.values, 12))
                if frame[MIDDLE].abs().max() > least:
                    found.setdefault(place, {})[name] = frame
    return {place: found[place] for place in list(found)[:MOST]}


def draw(bands: Bands) -> Figure:
    """Return the figure of bands."""
    across = min(ACROSS, len(bands))
    with chart(-(-len(bands) // across), across, [HEIGHT], "time (ms)") as (figure, axes):
        for ax, (place, waves) in zip(axes.flat, bands.items(), strict=False):
            for name, wave in waves.items():
                look, ms = style(name), 1e3 * wave.index.to_numpy()
                shade: dict[str, Any] = {"color": look.colour, "alpha": 0.2, "linewidth": 0}
                ax.fill_between(ms, wave[LOW], wave[HIGH], zorder=1 + look.order, **shade)
                thin = look._replace(width=1.3)
                ax.plot(ms, wave[MIDDLE], label=label_of(name), **thin.of_line())
            set_heading(ax, place.heading)
            ax.set_ylabel(UNITS[place.quantity])
    return figure


def table(bands: Bands) -> pd.DataFrame:
    """Return the data of the bands, SI: time first."""
    columns = {
        f"{name} {q} | {place.heading} ({UNITS[place.quantity]})": wave[q]
        for place, waves in bands.items()
        for name, wave in waves.items()
        for q in PERCENTILES
    }
    return pd.DataFrame(columns).rename_axis("time (s)").reset_index()
