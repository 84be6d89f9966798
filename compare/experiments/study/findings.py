"""The findings of a study: orders of convergence with theory, and results in sentences."""

import math
from itertools import pairwise
from math import isfinite, isnan
from typing import NamedTuple

import numpy as np

from compare.experiments.study.measure import PointRow
from compare.experiments.study.pareto import (
    Cheapest,
    cheapest,
    digits_per_second,
    floor,
    most_digits_per_second,
)
from compare.experiments.study.study import Curve, FineRun, Study
from compare.report.tables import percent

ROUND_OFF = 1e-11  # below, an error no longer falls
KNOWN = 10  # least ratio of an error to its floor for an order accurate to some per cent


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
