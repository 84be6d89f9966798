"""The findings of a study: orders of convergence, the Pareto front, and results in sentences.

A point counts with the largest error of itself and all finer points of its curve: accuracy lost in
a finer step was luck.
"""

import math
from itertools import pairwise
from math import isfinite, isnan
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from compare.experiments.study.check import ARGUMENTS
from compare.experiments.study.measure import PointRow
from compare.experiments.study.study import Curve, FineRun, Study
from compare.misfit.metrics import JUDGED
from compare.text import percent

TARGETS = (0.1, 0.01, 1e-3, 1e-4)
CLEARLY = 0.9  # of the expected error: a smaller one is due to cancellation

ROUND_OFF = 1e-11  # below, an error no longer falls
KNOWN = 10  # least ratio of an error to its floor for an order accurate to some per cent


def judged(rows: list[PointRow]) -> list[PointRow]:
    """Return the rows with the error assigned to each, and whether errors cancel in it."""
    totals, numericals = assured(rows, "total"), assured(rows, "numerical")
    found = []
    for row, total, numerical in zip(rows, totals, numericals, strict=True):
        held = numerical if math.isnan(total) else total
        # More accurate than the larger of its errors, or than a finer point.
        alone = max(row.numerical, row.modelling)
        counted = row.numerical if math.isnan(row.total) else row.total
        cancels = row.measured < CLEARLY * alone or counted < CLEARLY * held
        found.append(row._replace(held=held, cancels=cancels))
    return found


def assured(rows: list[PointRow], error: str) -> list[float]:
    """Return the largest error of each row and of all finer points of its curve; nan if a point has
    none."""
    errors = np.array([getattr(r, error) if r.state == "done" else math.nan for r in rows])
    size = np.array([(r.freedoms, r.steps) for r in rows])
    model = np.array([f"{r.curve} {_physics(r)}" for r in rows])
    least = np.nan_to_num(errors, nan=0.0)
    return [
        float(np.max(least, where=_finer(size, i) & (model == model[i]), initial=errors[i]))
        for i in range(len(rows))
    ]


def _finer(size: np.ndarray, i: int) -> np.ndarray:
    """Return which points are at least as fine as point i: in freedoms and steps or, if these are
    not counted, by their position in the curve."""
    if np.isnan(size[i]).any():
        return np.arange(len(size)) >= i
    return (size >= size[i]).all(axis=1)


def _physics(row: PointRow) -> dict[str, Any]:
    """Return the varied keys other than numerics and block size: these change the problem."""
    free = {"pillar.block", *ARGUMENTS}
    found = sorted(row.settings.items())
    return {k: v for k, v in found if k not in free and not k.startswith("numerics.")}


class Cheapest(NamedTuple):
    """The cheapest point within a misfit, and that of another curve; None if there is none."""

    misfit: float
    row: PointRow
    next_best: PointRow | None


def measured(rows: list[PointRow], error: str, cost: str) -> list[PointRow]:
    """Return the rows that have both numbers, of points that were done."""
    return [
        row
        for row in rows
        if row.state == "done" and getattr(row, error) > 0 and getattr(row, cost) > 0
    ]


def front(rows: list[PointRow], error: str = "total", cost: str = "seconds") -> list[PointRow]:
    """Return the points not dominated in both numbers, the cheapest first (Pareto front), with the
    error assigned to each."""
    found: list[PointRow] = []
    least = math.inf
    held = {id(row): value for row, value in zip(rows, assured(rows, error), strict=True)}
    points = [(getattr(row, cost), held[id(row)], row) for row in measured(rows, error, cost)]
    for _, value, row in sorted(points, key=itemgetter(0, 1)):
        if value < least:
            least = value
            found.append(row)
    return found


def cheapest(rows: list[PointRow]) -> list[Cheapest]:
    """Return the cheapest point within each of `TARGETS`, if there is one and if the reference of
    errors is known to a tenth of the target."""
    found, rows = [], sorted(judged(measured(rows, "total", "seconds")), key=lambda r: r.seconds)
    for target in TARGETS:
        within = [r for r in rows if r.held <= target and JUDGED * r.total_floor <= target]
        if within:
            best = within[0]
            others = (r for r in within if r.curve != best.curve)
            found.append(Cheapest(target, best, next(others, None)))
    return found


def floor(rows: list[PointRow], error: str) -> float:
    """Return the error below which errors are not known; 0 against exact solutions. For totals it
    is that of the finest physics, without that of each curve's own model."""
    if error == "total":
        of_finest = [r.total_floor - r.numerical_floor for r in rows]
        return _largest(of_finest) or _largest([r.total_floor for r in rows])
    return _largest([getattr(row, f"{error}_floor", 0.0) for row in rows])


def _largest(floors: list[float]) -> float:
    return max((value for value in floors if not math.isnan(value)), default=0.0)


def is_known(row: PointRow, error: str) -> bool:
    """Return whether a point's error is at least the floor of its reference."""
    return getattr(row, error) >= floor([row], error)


def most_digits_per_second(rows: list[PointRow]) -> PointRow | None:
    """Return the point with the most digits of the finest physics per second, None without."""
    known = measured(rows, "total", "seconds")
    return max(judged(known), key=digits_per_second, default=None)


def digits_per_second(row: PointRow) -> float:
    """Return the correct decimal digits of a judged point per second of stepping: of the finest
    physics if that is known, else of its own model; nan without either."""
    return -math.log10(row.held) / row.seconds if row.held > 0 and row.seconds > 0 else math.nan


class Order(NamedTuple):
    """The order measured along one curve: that between its two finest points, with the varied
    key or its inverse; all of them; and the theoretical one."""

    curve: str
    key: str
    measured: float
    steps: list[float]
    theory: float


def orders(study: Study, rows: list[PointRow]) -> list[Order]:
    """Return the orders of all curves with a theoretical order and at least two points."""
    found = [_order(curve, [r for r in rows if r.curve == curve.label]) for curve in study.curves]
    return [order for order in found if order is not None]


def _order(curve: Curve, rows: list[PointRow]) -> Order | None:
    numeric = [k for k, v in curve.vary.items() if len(v) > 1 and np.isreal(v[0])]
    done = [r for r in rows if r.state == "done" and r.numerical > _least(r)]
    if curve.order is None or len(numeric) != 1:
        return None
    (key,) = numeric
    # The error falls along the points, whichever way the key goes; two fractions may be one step.
    done = list({_size(row, key): row for row in done}.values())
    done.sort(key=lambda row: -row.numerical)
    steps = [
        abs(math.log(a.numerical / b.numerical) / math.log(_size(a, key) / _size(b, key)))
        for a, b in pairwise(done)
    ]
    return Order(curve.label, key, steps[-1], steps, curve.order) if steps else None


def _least(row: PointRow) -> float:
    floor = row.numerical_floor
    return ROUND_OFF if math.isnan(floor) else max(ROUND_OFF, KNOWN * floor)


def _size(row: PointRow, key: str) -> float:
    """Return the actual step if a key of steps is varied, else the key's value."""
    return row.dt if "step" in key else float(row.settings[key])


def sentences(study: Study, rows: list[PointRow]) -> list[str]:
    """Return the findings of a timed study: the cheapest point within each misfit, and the extra
    cost of the next best curve; the most digits per second; where errors cancel; and the accuracy
    of the finest physics, if it is a fine run."""
    if not study.timed or all(isnan(row.total) for row in rows):
        return []
    found = [_cheapest(target) for target in cheapest(rows)]
    if best := most_digits_per_second(rows):
        found.append(
            f"The most digits per second, {digits_per_second(best):.2g}, come from {best.curve} "
            f"at {percent(best.held)} %."
        )
    found += _cancelling([row for row in rows if row.cancels])
    if isinstance(study.finest, FineRun):
        found.append(
            f"The finest physics is a fine run of {study.finest.method}; a coarser one is "
            f"{percent(floor(rows, 'total'))} % from it."
        )
    failed = [row for row in rows if row.state == "failed"]
    if failed:
        found.append(f"{len(failed)} of {len(rows)} points failed; they are listed in the table.")
    return found


def _cheapest(target: Cheapest) -> str:
    row, other = target.row, target.next_best
    text = (
        f"Within {percent(target.misfit)} % of the finest physics the cheapest is {row.curve} "
        f"({_errors(row)}; {_costs(row)})"
    )
    if other is None:
        return f"{text}; no other curve reaches it."
    times = f"{other.seconds / row.seconds:.3g} times as long"
    return (
        f"{text}; the next best, {other.curve} ({_errors(other)}; {_costs(other)}), steps {times}."
    )


def _errors(row: PointRow) -> str:
    parts = f"numerical {percent(row.numerical)} % + modelling {percent(row.modelling)} %"
    return f"{parts} = {percent(row.total)} %"


def _costs(row: PointRow) -> str:
    """Return the cost of a point: set-up and steps of each run, compiling of the first one."""
    named = {"set-up": row.setup, "compiling": row.compile, "stepping": row.seconds}
    said = {name: _seconds(value) for name, value in named.items() if isfinite(value)}
    return ", ".join(f"{name} {value}" for name, value in said.items())


def _seconds(value: float) -> str:
    return f"{value:.2g} s" if value >= 0.1 else f"{max(1e3 * value, 0.1):.2g} ms"


def _cancelling(rows: list[PointRow]) -> list[str]:
    near = [row for row in rows if row.measured > 0]
    if not near:
        return []
    most = min(near, key=lambda row: row.measured / row.held)
    return [
        f"At {len(rows)} points errors cancel, or a finer step is worse; they are marked, and "
        f"count for what all finer points of their curve hold: {most.curve} measures "
        f"{percent(most.measured)} % from the finest physics and counts for {percent(most.held)} %."
    ]
