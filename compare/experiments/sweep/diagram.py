"""Figures of an ensemble: bands of its waveforms, and the distribution of its misfits.

Bands extend from the 5th to the 95th percentile at every time, with the median as a line; a
distribution is the share of members whose misfit is at most that on the axis.
"""

import io
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cases.errors import SceneError
from cases.files import read_text
from compare.engines import in_order
from compare.experiments.ablation.diagram import COLOURS
from compare.experiments.sweep.axis import MEMBER
from compare.experiments.sweep.ensemble import ENSEMBLE
from compare.figures.export import blank
from compare.figures.figure import SceneFigure
from compare.figures.style import RC, WIDTH, style
from compare.figures.units import UNITS
from compare.misfit.places import Place, places_of
from compare.scenes import find
from results.netcdf import load_netcdf

SEEN = ("stress", "velocity", "traction", "gap", "slip")  # of a result
MOST, COLUMNS = 12, 2  # waveforms drawn, and side by side
TALL = 1.9  # inches of each
WIDE = 1.3  # points, of every curve
DASHES = ("-", (0, (5, 2)), (0, (1.5, 1.5)))
FAINT = 1e-6  # of the largest of its quantity: a waveform of round-off
LARGEST_FILE = 100_000_000  # bytes of a table: a row for each pair of each member
LOW, MIDDLE, HIGH = "p5", "p50", "p95"
WAVEFORMS = "Waveforms of an ensemble: median and 5 to 95 % of its members"
MISFITS = "Misfits of an ensemble: the worst of each member"
OF_BANDS = (
    "At every time the median of all members, and the band from the 5th to the 95th percentile."
)
OF_MISFITS = "The share of members whose worst misfit of a pair is at most that on the axis."


def pictures(
    waves: list[Path], done: pd.DataFrame, axes: list[str], out: Path
) -> Iterator[tuple[Path, SceneFigure]]:
    """Yield the figures of an ensemble, each with its folder: the bands of the waveforms in each,
    and for comparisons the misfits of each variant at each point.

    waves : files of statistics. done : rows of the table. axes : swept keys without the member.
    """
    for folder in dict.fromkeys(file.parent for file in waves):
        results = statistics_in(folder)
        if shown_places(results):
            table, drawing = band_table(results), partial(bands, results)
            yield folder, SceneFigure(f"{ENSEMBLE}-waveforms", WAVEFORMS, OF_BANDS, drawing, table)
    for point, rows in done.groupby([*axes, "variant"], sort=False) if "one" in done else ():
        worst = misfits_of(rows)
        if len(worst):
            rest = ",".join(f"{key}={value}" for key, value in zip(axes, point, strict=False))
            place, drawing = out / rest / str(point[-1]), partial(distribution, worst)
            yield place, SceneFigure(f"{ENSEMBLE}-misfits", MISFITS, OF_MISFITS, drawing, worst)


def statistics_in(folder: Path) -> dict[str, xr.Dataset]:
    """Return the statistics of every waveform in a folder by the name of the solver; raises
    SceneError if there are none."""
    end = f"-{ENSEMBLE}.nc"
    found = {file.name.removesuffix(end): load_netcdf(file) for file in folder.glob(f"*{end}")}
    if not found:
        allowed = f"has no *{end}, which --ensemble writes"
        raise SceneError(str(folder), "", None, allowed)
    return found


def ensemble_in(out: Path) -> tuple[Path, list[SceneFigure]]:
    """Return the scene's file and the figures, with unique names, of a folder written by
    `--ensemble`; raises SceneError for any other folder."""
    waves = sorted(out.rglob(f"*-{ENSEMBLE}.nc"))
    try:
        text = io.StringIO(read_text(out / "sweep.csv", LARGEST_FILE))
        rows = pd.read_csv(text, dtype={"faint": str}).fillna({"variant": ""})
        rows, axes = rows[rows.state == "done"], list(rows)[: list(rows).index("variant")]
        scene = find(load_netcdf(out / "sweep.nc").attrs["scene"])
    except (OSError, ValueError, KeyError, AttributeError):
        allowed = "must be a folder that --ensemble has written"
        raise SceneError("--ensemble", str(out), None, allowed) from None
    found = pictures(waves, rows, [key for key in axes if key != MEMBER], out)
    return scene, [
        replace(
            one, name=f"{one.name}-{k}", title=", ".join([one.title, *of.relative_to(out).parts])
        )
        for k, (of, one) in enumerate(found)
    ]


def bands(results: dict[str, xr.Dataset], width: float = WIDTH, rc: dict[Any, Any] = RC) -> Figure:
    """Return the bands of an ensemble; results : mean and percentiles of every waveform by the name
    of the solver, with `statistic` as their first dimension; width : inches; rc : settings of
    matplotlib."""
    places = shown_places(results)
    columns = min(COLUMNS, len(places))
    rows = -(-len(places) // columns)
    with blank(0.5 + TALL * rows, width, rc=rc) as figure:
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
        for ax, place in zip(grid, places, strict=False):
            for name in in_order(results):
                _draw_band(ax, results[name], name, place)
            ax.set_title(place.heading)
            ax.set_ylabel(UNITS[place.quantity])
        for ax in grid[len(places) :]:
            ax.set_axis_off()
        for ax in grid[len(places) - columns : len(places)]:
            ax.set_xlabel("time (ms)")
            ax.tick_params(labelbottom=True)
        _legend(figure, in_order(results))
    return figure


def shown_places(results: dict[str, xr.Dataset]) -> list[Place]:
    """Return the waveforms drawn as bands: those that some solution has and that exceed round-off,
    at most MOST."""
    found: dict[Place, None] = {}
    for result in results.values():
        middle = result.sel(statistic=MIDDLE)
        for quantity in (name for name in SEEN if name in result):
            at, components = places_of(middle, quantity)
            every = [Place(quantity, part, one) for one in at for part in components]
            sizes = [_size(middle, place) for place in every]
            loud = zip(every, sizes, strict=True)
            found |= {place: None for place, size in loud if size > FAINT * max(sizes)}
    return list(found)[:MOST]


def _size(result: xr.Dataset, place: Place) -> float:
    wave = place.waveform(result)
    return 0.0 if wave is None else float(np.nan_to_num(np.abs(wave)).max(initial=0.0))


def _draw_band(ax: Axes, result: xr.Dataset, name: str, place: Place) -> None:
    low, middle, high = (place.waveform(result.sel(statistic=q)) for q in (LOW, MIDDLE, HIGH))
    if low is None or middle is None or high is None:
        return
    ms, look = 1e3 * result.time.values, style(name)
    ax.fill_between(ms, low, high, color=look.colour, alpha=0.2, linewidth=0, zorder=1 + look.order)
    ax.plot(ms, middle, **_line(name))


def _line(name: str) -> dict[str, Any]:
    """Return the line style of a median: thin, so that it does not hide its band."""
    return style(name).of_line() | {"linewidth": WIDE}


def _legend(figure: Figure, names: list[str]) -> None:
    from matplotlib.lines import Line2D

    handles: list[Any] = [Line2D([], [], **_line(name)) for name in names]
    figure.legend(handles, names, loc="outside upper left", ncols=len(names), frameon=False)


def band_table(results: dict[str, xr.Dataset]) -> pd.DataFrame:
    """Return the data of the bands, SI: time first."""
    columns: dict[str, np.ndarray] = {}
    for name, result in results.items():
        columns.setdefault("time (s)", result.time.values)
        for place in shown_places(results):
            for q in (LOW, MIDDLE, HIGH):
                wave = place.waveform(result.sel(statistic=q))
                if wave is not None and len(wave) == len(columns["time (s)"]):
                    columns[f"{name} {q} | {place.heading} ({UNITS[place.quantity]})"] = wave
    return pd.DataFrame(columns)


def misfits_of(done: pd.DataFrame) -> pd.DataFrame:
    """Return the worst misfit of every pair and member of the rows of comparisons, ascending, with
    the share of members up to it."""
    loud = done[done.faint == "false"]
    found = []
    for (one, other), rows in loud.groupby(["one", "other"], sort=False):
        worst = np.sort(rows.groupby("member").misfit.max().to_numpy(dtype=float))
        share = np.arange(1, len(worst) + 1) / len(worst)
        pair = f"{one} ~ {other}"
        found.append(pd.DataFrame({"pair": pair, "misfit": worst, "share": share}))
    return pd.concat(found, ignore_index=True) if found else pd.DataFrame()


def distribution(table: pd.DataFrame) -> Figure:
    """Return the distribution of misfits of `misfits_of`, one step curve per pair."""
    with blank(3.6) as figure:
        ax = figure.subplots()
        looks = cycle(product(DASHES, COLOURS))
        for (pair, rows), (dashes, colour) in zip(
            table.groupby("pair", sort=False), looks, strict=False
        ):
            line: dict[str, Any] = {"linestyle": dashes, "color": colour, "linewidth": WIDE}
            percent = 100 * rows.misfit.to_numpy()
            at = np.concatenate([percent[:1], percent])
            ax.step(at, np.append(0.0, rows.share), where="post", label=pair, **line)
        ax.set_xscale("log")
        ax.set_ylim(0, 1.02)
        ax.set_xlabel("worst misfit of a member, %")
        ax.set_ylabel("cumulative share of members")
        ax.grid(which="major", color="#e4e7ea", linewidth=0.6)
        figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    return figure
