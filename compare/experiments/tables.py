"""The tables of experiments: one row a point or an effect, as CSV and as NetCDF."""

import json
from collections.abc import Iterable, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from compare.runs.output import write, write_csv


def cell(value: Any) -> Any:
    """Return a value that a table can hold: lists and dictionaries as JSON."""
    return json.dumps(value, default=str) if isinstance(value, list | dict) else value


def frame(rows: Sequence[Any], form: type) -> pd.DataFrame:
    """Return rows of a NamedTuple as a table, SI."""
    return pd.DataFrame([map(cell, row) for row in rows], columns=list(form._fields))  # type: ignore[attr-defined]


def write_tables(
    folder: Path, name: str, table: pd.DataFrame, data: xr.Dataset | None = None
) -> list[Path]:
    """Write NAME.csv and, of a dataset, NAME.nc into a folder; return the files."""
    files = [write_csv(folder / f"{name}.csv", table)]
    if data is not None:
        texts = {k: v.astype(str) for k, v in data.variables.items() if v.dtype == object}
        safe, place = data.assign(texts), folder / f"{name}.nc"
        files.append(write(place, lambda path: safe.to_netcdf(path, engine="scipy")))
    return files


def grouped(rows: Iterable[tuple[str, list[str]]]) -> dict[str, list[list[str]]]:
    """Return rows of cells by the heading that comes with each, headings in their order."""
    found: dict[str, list[list[str]]] = {}
    for heading, cells in rows:
        found.setdefault(heading, []).append(cells)
    return found


def number(value: float, form: str, missing: str = "") -> str:
    """Return a number as text; `missing` where it is not finite."""
    return format(value, form) if isfinite(value) else missing
