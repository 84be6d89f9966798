"""Which points of a study no other one beats, and what the cheapest of them reach.

A point counts for the error that it and all finer points of its curve hold: what a finer step
undoes was luck.
"""

import math
from typing import NamedTuple

import numpy as np

from compare.experiments.study.check import ARGUMENTS
from compare.experiments.study.measure import Row
from compare.misfit.metrics import JUDGED

TARGETS = (0.1, 0.01, 1e-3, 1e-4)
CLEARLY = 0.9  # of what it should be: below, an error is small by cancellation


def judged(rows: list[Row]) -> list[Row]:
    """Return the rows with what each counts for, and whether errors cancel in it."""
    totals, numericals = assured(rows, "total"), assured(rows, "numerical")
    found = []
    for row, total, numerical in zip(rows, totals, numericals, strict=True):
        held = numerical if math.isnan(total) else total
        found.append(row._replace(held=held, cancels=_cancels(row, held)))
    return found


def _cancels(row: Row, held: float) -> bool:
    """Return whether a point is nearer than the larger of its errors, or than a finer point."""
    alone = max(row.numerical, row.modelling)
    return row.measured < CLEARLY * alone or _counted(row) < CLEARLY * held


def _counted(row: Row) -> float:
    return row.numerical if math.isnan(row.total) else row.total


def assured(rows: list[Row], error: str) -> list[float]:
    """Return the largest error of each row and of all finer points of its curve; nan where a point
    has none."""
    found = [math.nan] * len(rows)
    for curve in dict.fromkeys(row.curve for row in rows):
        mine = [i for i, row in enumerate(rows) if row.curve == curve]
        for i, value in zip(mine, _assured([rows[i] for i in mine], error), strict=True):
            found[i] = value
    return found


def _assured(curve: list[Row], error: str) -> list[float]:
    errors = np.array([getattr(r, error) if r.state == "done" else math.nan for r in curve])
    size = np.array([(r.freedoms, r.steps) for r in curve])
    model = np.array([_model(r) for r in curve])
    least = np.nan_to_num(errors, nan=0.0)
    return [
        float(np.max(least, where=_finer(size, i) & (model == model[i]), initial=errors[i]))
        for i in range(len(curve))
    ]


def _finer(size: np.ndarray, i: int) -> np.ndarray:
    """Return which points are at least as fine as one: with as many freedoms and steps; later in
    the curve where these are not counted."""
    if np.isnan(size[i]).any():
        return np.arange(len(size)) >= i
    return (size >= size[i]).all(axis=1)


def _model(row: Row) -> str:
    """Return what is varied beside the numerics and the size of blocks: another problem."""
    free = {"pillar.block", *ARGUMENTS}
    kept = {k: v for k, v in row.settings.items() if k not in free and k[:9] != "numerics."}
    return str(sorted(kept.items()))


class Cheapest(NamedTuple):
    """The cheapest point within a misfit, and that of another curve; None where there is none."""

    misfit: float
    row: Row
    next_best: Row | None


def measured(rows: list[Row], error: str, cost: str) -> list[Row]:
    """Return the rows that have both numbers, of points that were done."""
    return [
        row
        for row in rows
        if row.state == "done" and getattr(row, error) > 0 and getattr(row, cost) > 0
    ]


def front(rows: list[Row], error: str = "total", cost: str = "seconds") -> list[Row]:
    """Return the points that no other one beats in both, the cheapest first (Pareto's front), each
    by the error that it counts for."""
    found: list[Row] = []
    least = math.inf
    known = {id(row): value for row, value in zip(rows, assured(rows, error), strict=True)}
    ordered = sorted(
        measured(rows, error, cost), key=lambda row: (getattr(row, cost), known[id(row)])
    )
    for row in ordered:
        if known[id(row)] < least:
            least = known[id(row)]
            found.append(row)
    return found


def cheapest(rows: list[Row]) -> list[Cheapest]:
    """Return the cheapest point within each of `TARGETS`, as far as there are any, and as what
    errors are measured from is known to a tenth of it."""
    found, rows = [], sorted(judged(measured(rows, "total", "seconds")), key=lambda r: r.seconds)
    for target in TARGETS:
        within = [r for r in rows if r.held <= target and JUDGED * r.total_floor <= target]
        if within:
            best = within[0]
            others = (r for r in within if r.curve != best.curve)
            found.append(Cheapest(target, best, next(others, None)))
    return found


def floor(rows: list[Row], error: str) -> float:
    """Return the error below which these are not known; 0 against exact solutions. Of totals that
    of the finest physics, without what is not known of each curve's own model."""
    if error == "total":
        of_finest = [r.total_floor - r.numerical_floor for r in rows]
        return _largest(of_finest) or _largest([r.total_floor for r in rows])
    return _largest([getattr(row, f"{error}_floor", 0.0) for row in rows])


def _largest(floors: list[float]) -> float:
    return max((value for value in floors if not math.isnan(value)), default=0.0)


def is_known(row: Row, error: str) -> bool:
    """Return whether a point's error is not below what it is measured against is known to."""
    return getattr(row, error) >= floor([row], error)


def most_digits_per_second(rows: list[Row]) -> Row | None:
    """Return the point that gets the most digits of the finest physics a second, None without."""
    known = measured(rows, "total", "seconds")
    return max(judged(known), key=digits_per_second, default=None)


def digits_per_second(row: Row) -> float:
    """Return the decimal digits that a judged point gets right over the seconds that it steps: of
    the finest physics where that is known, else of its own model; nan without either."""
    return -math.log10(row.held) / row.seconds if row.held > 0 and row.seconds > 0 else math.nan
