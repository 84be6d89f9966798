"""Orders of convergence: how fast an error falls along a curve, beside what theory says."""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from compare.experiments.study.measure import PointRow
from compare.experiments.study.study import Curve, Study

ROUND_OFF = 1e-11  # below, an error no longer falls
KNOWN = 10  # times its floor an error must be for its order to hold to some per cent


class Order(NamedTuple):
    """The order measured along one curve: that between its two finest points, with the varied
    key or its inverse; all of them; and what theory says."""

    curve: str
    key: str
    measured: float
    steps: list[float]
    theory: float


def orders(study: Study, rows: list[PointRow]) -> list[Order]:
    """Return the orders of all curves that have one in theory, and two points at least."""
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
    """Return the step that was taken where a key of steps is varied, else the key's value."""
    return row.dt if "step" in key else float(row.settings[key])
