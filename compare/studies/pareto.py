"""Which points of a study no other one beats, and what the cheapest of them reach."""

import math
from typing import NamedTuple

from compare.studies.measure import Row

TARGETS = (0.1, 0.01, 1e-3, 1e-4)


class Cheapest(NamedTuple):
    """The cheapest point within a misfit."""

    misfit: float
    row: Row


def measured(rows: list[Row], error: str, cost: str) -> list[Row]:
    """Return the rows that have both numbers, of points that were done."""
    return [
        row
        for row in rows
        if row.state == "done" and getattr(row, error) > 0 and getattr(row, cost) > 0
    ]


def front(rows: list[Row], error: str = "total", cost: str = "seconds") -> list[Row]:
    """Return the points that no other one beats in both, the cheapest first (Pareto's front)."""
    found: list[Row] = []
    least = math.inf
    ordered = sorted(
        measured(rows, error, cost), key=lambda row: (getattr(row, cost), getattr(row, error))
    )
    for row in ordered:
        if getattr(row, error) < least:
            least = getattr(row, error)
            found.append(row)
    return found


def cheapest(rows: list[Row], error: str = "total", cost: str = "seconds") -> list[Cheapest]:
    """Return the cheapest point within each of `TARGETS`, as far as there are any, and as errors
    are known."""
    found, least = [], floor(rows, error)
    for target in TARGETS:
        if target < least:
            break
        within = [r for r in front(rows, error, cost) if getattr(r, error) <= target]
        if within:
            found.append(Cheapest(target, within[0]))
    return found


def floor(rows: list[Row], error: str) -> float:
    """Return the error below which these are not known; 0 against exact solutions."""
    floors = [getattr(row, f"{error}_floor", 0.0) for row in rows]
    return max((value for value in floors if not math.isnan(value)), default=0.0)


def is_known(row: Row, error: str) -> bool:
    """Return whether a point's error is not below what it is measured against is known to."""
    return getattr(row, error) >= floor([row], error)


def most_digits_per_second(rows: list[Row]) -> Row | None:
    """Return the point that gets the most digits of the finest physics a second, None without."""
    known = measured(rows, "total", "seconds")
    return max(known, key=digits_per_second, default=None)


def digits_per_second(row: Row) -> float:
    """Return the decimal digits that a point gets right over the seconds that it steps: of the
    finest physics where that is known, else of its own model; nan without either."""
    error = row.numerical if math.isnan(row.total) else row.total
    return -math.log10(error) / row.seconds if error > 0 and row.seconds > 0 else math.nan
