"""Run the robustness suite: every case on every solver once, and the stability maps."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from compare.engines import ENGINES, Progress
from compare.experiments import store
from compare.experiments.pool import Pool
from compare.experiments.robustness.case import SOLVERS
from compare.experiments.robustness.map import StabilityMap, make_map
from compare.experiments.robustness.row import Row, row_of
from compare.experiments.robustness.suite import CASES
from compare.experiments.store import Store

RATE = "hard case"  # what the seconds of rows are remembered by
Place = tuple[int, int]  # the numbers of a case and of a solver


class Cells(NamedTuple):
    """A map as it is saved."""

    ratio: list[float]
    step: list[float]
    stable: list[list[bool]]


def places(slow: bool = True) -> list[Place]:
    """Return the places of all rows, in the order of the report; slow : also of long ones."""
    return [
        (i, j) for i, case in enumerate(CASES) if slow or not case.slow for j in range(len(SOLVERS))
    ]


def row_at(place: Place) -> Row:
    """Return the row of one place."""
    return row_of(CASES[place[0]], SOLVERS[place[1]])


def key(place: Place) -> str:
    """Return what tells rows apart: everything that decides one."""
    case, solver = CASES[place[0]], SOLVERS[place[1]]
    return store.key(case.name, case.scene, case.changes, solver.name)


def run(
    pool: Pool | None = None,
    slow: bool = True,
    progress: Progress | None = None,
    folder: Path | None = None,
) -> list[Row]:
    """Return all rows; folder : where they are saved; None: nowhere."""
    rows: Store[Row] = Store(Row, folder)
    return rows.compute(places(slow), key, row_at, pool, progress, RATE)


def run_maps(pool: Pool | None, folder: Path) -> list[StabilityMap]:
    """Return the maps of all engines, saved in `folder`."""
    maps: Store[Cells] = Store(Cells, folder)
    names = list(ENGINES)
    found = maps.compute(names, store.key, cells, pool)
    return [StabilityMap(e, *map(np.array, one)) for e, one in zip(names, found, strict=True)]


def cells(engine: str) -> Cells:
    """Return the map of an engine as lists."""
    return Cells(*(part.tolist() for part in make_map(engine)[1:]))
