"""The battery run as a whole: every case on every solver, in parallel where there are workers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from concurrent.futures import Executor, as_completed
from contextlib import nullcontext
from pathlib import Path
from typing import NamedTuple

import numpy as np

from compare.engines import Progress
from compare.experiments.cost import timings
from compare.experiments.robustness.case import SOLVERS
from compare.experiments.robustness.map import ENGINES, StabilityMap, make_map
from compare.experiments.robustness.row import Row, row_of
from compare.experiments.robustness.suite import CASES
from compare.experiments.study.runner import program
from compare.runs.output import read_kept, write_text

Pool = Callable[[], Executor]


class Cells(NamedTuple):
    """A map as it is kept."""

    ratio: list[float]
    step: list[float]
    stable: list[list[bool]]


RATE = "hard case"  # what the seconds of rows are remembered by


def places(slow: bool = True) -> list[tuple[int, int]]:
    """Return the numbers of case and solver of every row, in the order of the report.

    slow : also of those that take long.
    """
    return [
        (i, j) for i, case in enumerate(CASES) if slow or not case.slow for j in range(len(SOLVERS))
    ]


def row_at(place: tuple[int, int]) -> Row:
    """Return the row of one place: what a process of a pool does."""
    return row_of(CASES[place[0]], SOLVERS[place[1]])


def run(
    pool: Pool | None = None,
    slow: bool = True,
    progress: Progress | None = None,
    folder: Path | None = None,
) -> list[Row]:
    """Return all rows.

    pool : makes the standard Executor that maps them; None: one by one. folder : where each is
    kept as soon as it is done, and taken from when the battery is run again; None: nowhere.
    """
    asked = places(slow)
    found = {place: row for place in asked if (row := _kept(place, folder)) is not None}

    def note(place: tuple[int, int], row: Row) -> None:
        found[place] = row
        if folder is not None:
            write_text(_file(place, folder), json.dumps(row._asdict()))
        if progress:
            progress(len(found) / len(asked))

    missing = [place for place in asked if place not in found]
    with timings.timing(RATE, len(missing)):
        if pool is None:
            for place in missing:
                note(place, row_at(place))
        elif missing:
            with pool() as executor:
                futures = {executor.submit(row_at, place): place for place in missing}
                for future in as_completed(futures):
                    note(futures[future], future.result())
    return [found[place] for place in asked]


def is_kept(place: tuple[int, int], folder: Path) -> bool:
    """Return whether a row is done."""
    return _file(place, folder).is_file()


def _kept(place: tuple[int, int], folder: Path | None) -> Row | None:
    if folder is None or not _file(place, folder).is_file():
        return None
    return read_kept(_file(place, folder), Row)


def _file(place: tuple[int, int], folder: Path) -> Path:
    """Return the file of a row, named by all that decides it, this program included."""
    case, solver = CASES[place[0]], SOLVERS[place[1]]
    about = [program(), case.name, case.scene, case.changes, solver.name]
    return folder / f"{_digest(about)}.json"


def run_maps(pool: Pool | None, folder: Path) -> list[StabilityMap]:
    """Return the maps of all engines, kept in `folder` as rows are."""
    files = {engine: folder / f"{_digest([program(), engine])}.json" for engine in ENGINES}
    missing = [engine for engine, file in files.items() if not file.is_file()]
    if missing:
        with nullcontext() if pool is None else pool() as executor:
            made = (map if executor is None else executor.map)(make_map, missing)
            for found in made:
                lists = {k: v.tolist() for k, v in found._asdict().items() if k != "engine"}
                write_text(files[found.engine], json.dumps(lists))
    return [
        StabilityMap(engine, *map(np.array, read_kept(file, Cells)))
        for engine, file in files.items()
    ]


def _digest(about: list) -> str:
    return hashlib.sha256(json.dumps(about).encode()).hexdigest()[:16]
