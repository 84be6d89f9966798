"""The battery run as a whole: every case on every solver, in parallel where there are workers."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, as_completed

from compare.engines import Progress
from compare.stability.battery import CASES
from compare.stability.case import SOLVERS
from compare.stability.row import Row, row_of

Pool = Callable[[], Executor]


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


def run(pool: Pool | None = None, slow: bool = True, progress: Progress | None = None) -> list[Row]:
    """Return all rows; pool : makes the standard Executor that maps them, None: one by one."""
    asked = places(slow)
    found: dict[tuple[int, int], Row] = {}

    def note(place: tuple[int, int], row: Row) -> None:
        found[place] = row
        if progress:
            progress(len(found) / len(asked))

    if pool is None:
        for place in asked:
            note(place, row_at(place))
    else:
        with pool() as executor:
            futures = {executor.submit(row_at, place): place for place in asked}
            for future in as_completed(futures):
                note(futures[future], future.result())
    return [found[place] for place in asked]
