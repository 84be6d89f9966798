"""The summary of an experiment, the same for the terminal, the page and JSON; its tables."""

import json
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
import xarray as xr

from compare.cli.terminal import print_json, progress, say, show_numbers, show_table
from compare.engines import Progress
from compare.figures.export import Drawn
from compare.report.tables import Table
from compare.runs.checkpoint.lock import locked
from compare.runs.output import write_csv, write_dataset
from compare.runs.processes import started
from compare.studies.store import Pool, on_pool, plain


class Summary(NamedTuple):
    """An experiment's summary for display.

    name : of its files, and of its section of the page. table : rows of cells under headings.
    has_text : whether cells are sentences, which the terminal wraps.
    sentences : its findings. failed : a line for each row that failed. facts : machine-readable.
    note : about all of it. legend : of the table, on the terminal. about : for the caption of the
    figure: its contents, the quantity of its misfits, or its scenes. timed : whether it has
    seconds.
    """

    name: str
    title: str
    table: Table
    sentences: Sequence[str]
    failed: Sequence[str]
    files: Sequence[Path]
    facts: Any
    figure: Drawn | None = None
    note: str = ""
    legend: str = ""
    about: str = ""
    timed: bool = False
    has_text: bool = False


def run_and_show(
    label: str,
    out: Path | None,
    workers: int,
    work: Callable[[Pool | None, Progress], Summary],
    as_json: bool,
) -> None:
    """Show the summary returned by `work(pool, progress)`; of several MPI processes only the first
    does.

    label : of the progress bar. out : a folder, locked meanwhile; None writes nothing.
    """
    processes = started()
    with ExitStack() as held, progress(label) as advance:
        if out is not None:
            processes.by_first(lambda: held.enter_context(locked(out)))
        found = on_pool(processes, workers, lambda pool: work(pool, advance))
    if found is not None:
        show(found, as_json)


def show(found: Summary, as_json: bool) -> None:
    """Print a summary: its table, its sentences and its files; or its facts."""
    if as_json:
        print_json(plain(found.facts))
        return
    _show_table(found.table, found.has_text)
    for line in filter(None, [found.legend, *found.sentences]):
        say(line)
    for line in found.failed:
        say(f"failed: {line}", "red")
    if found.note:
        say(found.note)
    if found.files:
        say(f"written: {', '.join(map(str, found.files))}")


def _show_table(table: Table, has_text: bool) -> None:
    """Print the groups of a table: separately if text must be wrapped, else as one table."""
    if not has_text and table.groups:
        show_numbers(table.header, table.groups)
        return
    for heading, rows in table.groups.items():
        say(heading, "bold")
        show_table(table.header, rows)


def cell(value: Any) -> Any:
    """Return a value for a table: lists and dictionaries as JSON."""
    return json.dumps(value, default=str) if isinstance(value, list | dict) else value


def frame(rows: Sequence[Any], form: type) -> pd.DataFrame:
    """Return rows of a NamedTuple as a table, SI."""
    return pd.DataFrame([map(cell, row) for row in rows], columns=list(form._fields))  # type: ignore[attr-defined]


def write_tables(
    folder: Path, name: str, table: pd.DataFrame, data: xr.Dataset | None = None
) -> list[Path]:
    """Write NAME.csv and, for a dataset, NAME.nc into a folder; return the files."""
    files = [write_csv(folder / f"{name}.csv", table)]
    if data is not None:
        files.append(write_dataset(folder / f"{name}.nc", data))
    return files


def grouped(rows: Iterable[tuple[str, list[str]]]) -> dict[str, list[list[str]]]:
    """Return rows of cells grouped by heading, headings in their order."""
    found: dict[str, list[list[str]]] = {}
    for heading, cells in rows:
        found.setdefault(heading, []).append(cells)
    return found


def number(value: float, form: str, missing: str = "") -> str:
    """Return a number as text; `missing` if it is not finite."""
    return format(value, form) if isfinite(value) else missing
