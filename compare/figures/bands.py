"""Bands of an ensemble's waveforms: the median of all members, and from the 5th to the 95th
percentile at every time."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import in_order
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import RC, WIDTH, style
from jointwave.compare.figures.units import UNITS
from jointwave.compare.misfit.places import Place, places_of
from jointwave.results.netcdf import load_netcdf

END = "-ensemble.nc"  # of the files of statistics, after the name of a result
SEEN = ("stress", "velocity", "traction", "gap", "slip")  # of a result
MOST, COLUMNS = 12, 2  # waveforms drawn, and side by side
FAINT = 1e-6  # of the largest of its quantity: a waveform of round-off
LOW, MIDDLE, HIGH = "p5", "p50", "p95"
TITLE = "Waveforms of an ensemble: median and 5 to 95 % of its members"


def statistics_in(folder: Path) -> dict[str, xr.Dataset]:
    """Return the statistics of every waveform in a folder by the name of the solver; raises
    SceneError if there are none."""
    files = sorted(folder.glob(f"*{END}"))
    if not files:
        raise SceneError(str(folder), "", None, f"has no *{END}, which --ensemble writes")
    return {file.name.removesuffix(END): load_netcdf(file) for file in files}


def draw(results: dict[str, xr.Dataset], width: float = WIDTH, rc: dict[Any, Any] = RC) -> Figure:
    """Return the bands of an ensemble.

    results : mean and percentiles of every waveform by the name of the solver, with `statistic` as
    their first dimension. width : inches. rc : settings of matplotlib.
    """
    places, names = shown_places(results), in_order(results)
    columns = min(COLUMNS, len(places))
    rows = -(-len(places) // columns)
    with blank(0.5 + 1.9 * rows, width, rc=rc) as figure:
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
        for ax, place in zip(grid, places, strict=False):
            for name in names:
                waves = _waves(results[name], place)
                if waves is None:
                    continue
                look, ms = style(name), 1e3 * results[name].time.values
                shade: dict[str, Any] = {"color": look.colour, "alpha": 0.2, "linewidth": 0}
                ax.fill_between(ms, waves[LOW], waves[HIGH], zorder=1 + look.order, **shade)
                ax.plot(ms, waves[MIDDLE], label=name, **look.of_line() | {"linewidth": 1.3})
            ax.set(title=place.heading, ylabel=UNITS[place.quantity])
        for ax in grid[len(places) :]:
            ax.set_axis_off()
        for ax in grid[len(places) - columns : len(places)]:
            ax.set_xlabel("time (ms)")
            ax.tick_params(labelbottom=True)
        entries = {
            label: line
            for ax in grid
            for line, label in zip(*ax.get_legend_handles_labels(), strict=True)
        }
        lines = [entries[name] for name in names if name in entries]
        figure.legend(handles=lines, loc="outside upper left", ncols=len(lines), frameon=False)
    return figure


def shown_places(results: dict[str, xr.Dataset]) -> list[Place]:
    """Return the waveforms drawn: those that some solution has and that exceed round-off, at most
    MOST."""
    found: dict[Place, None] = {}
    for result in results.values():
        middle = result.sel(statistic=MIDDLE)
        for quantity in (name for name in SEEN if name in result):
            at, components = places_of(middle, quantity)
            sizes = {}
            for place in (Place(quantity, part, one) for one in at for part in components):
                wave = place.waveform(middle)
                sizes[place] = 0.0 if wave is None else float(np.nanmax(np.abs(wave), initial=0.0))
            largest = max(sizes.values(), default=0.0)
            found |= {place: None for place, size in sizes.items() if size > FAINT * largest}
    return list(found)[:MOST]


def _waves(result: xr.Dataset, place: Place) -> dict[str, np.ndarray] | None:
    """Return the percentiles of a waveform; None if the solution does not have it."""
    waves = {q: place.waveform(result.sel(statistic=q)) for q in (LOW, MIDDLE, HIGH)}
    found = {q: wave for q, wave in waves.items() if wave is not None}
    return found if len(found) == len(waves) else None


def table(results: dict[str, xr.Dataset]) -> pd.DataFrame:
    """Return the data of the bands, SI: time first."""
    columns = {"time (s)": next(iter(results.values())).time.values}
    for name, result in results.items():
        for place in shown_places(results):
            for q, wave in (_waves(result, place) or {}).items():
                if len(wave) == len(columns["time (s)"]):
                    columns[f"{name} {q} | {place.heading} ({UNITS[place.quantity]})"] = wave
    return pd.DataFrame(columns)
