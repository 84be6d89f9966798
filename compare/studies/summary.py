"""The summary of a study, the same for the terminal, the page and JSON; the files of its table."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
import xarray as xr

from jointwave.compare.figures.export import Drawn
from jointwave.compare.runs.output import write_csv, write_dataset


class Summary(NamedTuple):
    """A study's summary for display.

    name : of its files, and of its section of the page. table : its numbers in display units, with
    a heading of groups and the label of a row as the levels of its index. sentences : its findings.
    failed : a line for each row that failed. facts : machine-readable. note : about all of it.
    legend : of the table. about : for the caption of the figure: its contents, the quantity of its
    misfits, or its scenes. timed : whether it has seconds.
    """

    name: str
    title: str
    table: pd.DataFrame
    sentences: Sequence[str]
    failed: Sequence[str]
    files: Sequence[Path]
    facts: Any
    figure: Drawn | None = None
    note: str = ""
    legend: str = ""
    about: str = ""
    timed: bool = False


def cell(value: Any) -> Any:
    """Return a value for a file's table: lists and dictionaries as JSON."""
    return json.dumps(value, default=str) if isinstance(value, list | dict) else value


def write_tables(
    folder: Path, name: str, table: pd.DataFrame, data: xr.Dataset | None = None
) -> list[Path]:
    """Write NAME.csv and, for a dataset, NAME.nc into a folder; return the files."""
    files = [write_csv(folder / f"{name}.csv", table)]
    if data is not None:
        files.append(write_dataset(folder / f"{name}.nc", data))
    return files
