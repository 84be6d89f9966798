"""The table of a sweep: tidy as CSV, and as NetCDF with the swept keys as dimensions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from compare.experiments.sweep.axis import Axis
from compare.experiments.sweep.case import Case, Outcome
from compare.misfit.metrics import Distance
from compare.runs.output import write, write_csv

NAME = "sweep"
#: The numbers of a run, of a receiver of it, and of a pair of solutions at a receiver.
OF_RUNS = ("steps", "freedoms", "seconds", "energy_residual")
OF_RECEIVERS, OF_PAIRS = ("peak", "time_of_peak"), Distance._fields
UNITS = {"y": "m", "time_of_peak": "s", "seconds": "s", "delay": "s"}


def frame(axes: list[Axis], wanted: list[Case], found: list[Outcome]) -> pd.DataFrame:
    """Return one row for each receiver of each run or pair, or for each case that failed; SI."""
    rows: list[dict[str, Any]] = []
    for case, one in zip(wanted, found, strict=True):
        point = {axis.key: plain(case.settings[axis.key]) for axis in axes}
        about = {**point, "variant": case.variant, "state": one.state, "message": one.message}
        rows += [{**about, **row} for row in one.rows or [{}]]
    return pd.DataFrame(rows)


def plain(value: Any) -> Any:
    """Return a value that can stand in a table: what holds several as JSON."""
    return json.dumps(value, default=str) if isinstance(value, list | dict) else value


def dataset(axes: list[Axis], table: pd.DataFrame, about: dict[str, str]) -> xr.Dataset:
    """Return the rows that are done on the grid of swept keys, variants, and engines or pairs.

    Where nothing is known of a place of the grid, there is nan.
    """
    done, point = table[table.state == "done"], [*(axis.key for axis in axes), "variant"]
    if "one" in table:
        pairs = done.assign(pair=done["one"] + " ~ " + done["other"])
        found = _grid(pairs, [*point, "pair", "quantity", "y"], OF_PAIRS)
    else:
        found = _grid(done, [*point, "engine", "quantity", "y"], OF_RECEIVERS)
        runs = done.drop_duplicates([*point, "engine"])
        found = found.merge(_grid(runs, [*point, "engine"], OF_RUNS))
    found = found.reindex({axis.key: list(map(plain, axis.values)) for axis in axes})
    for name, unit in UNITS.items():
        if name in found.variables:
            found[name].attrs["units"] = unit
    texts = {k: found[k].astype(str) for k in found.coords if found[k].dtype == object}
    return found.assign_coords(texts).assign_attrs(about)


def _grid(rows: pd.DataFrame, index: list[str], numbers: Sequence[str]) -> xr.Dataset:
    """Return columns of numbers on the grid of an index."""
    return rows.set_index(index)[list(numbers)].astype(float).to_xarray()


def write_table(
    folder: Path, axes: list[Axis], table: pd.DataFrame, about: dict[str, str]
) -> list[Path]:
    """Write sweep.csv and, where anything is done, sweep.nc into a folder; return them."""
    files = [write_csv(folder / f"{NAME}.csv", table)]
    if (table.state == "done").any():
        data = dataset(axes, table, about)
        place = folder / f"{NAME}.nc"
        files.append(write(place, lambda path: data.to_netcdf(path, engine="scipy")))
    return files
