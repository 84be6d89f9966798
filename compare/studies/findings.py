"""The findings of a study: ranked errors, orders of convergence, and results in sentences.

A point is ranked by the largest error among itself and all finer points of its curve: an error that
grows again with refinement was small by chance.
"""

from collections.abc import Iterator, Sequence
from math import isnan
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from jointwave.compare.misfit.metrics import JUDGED
from jointwave.compare.studies.measure import COUNTS, ERRORS, WORDS
from jointwave.compare.studies.store import Row
from jointwave.compare.studies.study import Curve, FineRun, Study
from jointwave.compare.text import in_seconds, percent

TARGETS = (0.1, 0.01, 1e-3, 1e-4)
CLEARLY = 0.9  # of the expected error; a smaller error is due to cancellation
ROUND_OFF = 1e-11  # below, an error no longer falls
KNOWN = 10  # least ratio of error to floor that gives the order to some per cent


def judged(rows: Sequence[Row]) -> pd.DataFrame:
    """Return the table of a study: one row per point, in order, SI.

    It adds two columns to those of `measure`: held, the error by which the point is ranked (the
    total, or if unknown the numerical error); cancels, whether its own error is clearly smaller.
    """
    numbers = dict.fromkeys((*ERRORS, *COUNTS), float)
    table = pd.DataFrame(rows, columns=[*WORDS, *numbers]).astype(numbers)
    held = _held(table, "total").fillna(_held(table, "numerical"))
    alone = table[["numerical", "modelling"]].max(axis=1)
    counted = table["total"].fillna(table["numerical"])
    cancels = (table["measured"] < CLEARLY * alone) | (counted < CLEARLY * held)
    return table.assign(held=held, cancels=cancels)


def _held(table: pd.DataFrame, error: str) -> pd.Series:
    """Return for each point the largest error among itself and finer points of its curve with the
    same physics; nan without error. A finer point has more work or, if not counted, a later row."""
    free = ("pillar.block", "numerics.")  # these do not change the problem
    physics = table["settings"].map(
        lambda of: repr(sorted((k, v) for k, v in of.items() if not k.startswith(free)))
    )
    model = table["curve"] + " " + physics
    finest_first = table.sort_values("work", kind="stable").index[::-1]
    errors = table[error].where(table["state"] == "done")[finest_first]
    return errors.groupby(model).cummax().sort_index()


def done(table: pd.DataFrame, error: str, cost: str) -> pd.DataFrame:
    """Return the completed points with positive error and cost."""
    return table[(table["state"] == "done") & (table[error] > 0) & (table[cost] > 0)]


def cheapest(table: pd.DataFrame, target: float) -> pd.DataFrame:
    """Return the cheapest point of each curve within a misfit, sorted by cost; only points whose
    references are known to a tenth of the misfit."""
    points = done(table, "total", "seconds").sort_values("seconds")
    within = (points["held"] <= target) & (JUDGED * points["total_floor"] <= target)
    return points[within].drop_duplicates("curve")


def floor(table: pd.DataFrame, error: str) -> float:
    """Return the error of the references, below which errors are not known; 0 for exact solutions.
    For totals: the error of the finest physics only, without that of the curves' own models."""
    largest = table[f"{error}_floor"].max()
    if error == "total":
        largest = (table["total_floor"] - table["numerical_floor"]).max() or largest
    return 0.0 if isnan(largest) else float(largest)


class Order(NamedTuple):
    """The order of convergence of a curve in its varied key, or in its inverse: measured between
    its two finest points, and in theory."""

    curve: str
    key: str
    measured: float
    theory: float


def orders(study: Study, table: pd.DataFrame) -> list[Order]:
    """Return the orders of all curves with a theoretical order and at least two points."""
    found = (_order(curve, table[table["curve"] == curve.label]) for curve in study.curves)
    return [order for order in found if order is not None]


def _order(curve: Curve, table: pd.DataFrame) -> Order | None:
    numeric = [k for k, v in curve.vary.items() if len(v) > 1 and np.isreal(v[0])]
    if curve.order is None or len(numeric) != 1:
        return None
    (key,) = numeric
    least = (KNOWN * table["numerical_floor"].fillna(0.0)).clip(lower=ROUND_OFF)
    known = table[(table["state"] == "done") & (table["numerical"] > least)]
    # Use the actual step if a step key is varied: two fractions may give the same step.
    size = known["dt"] if "step" in key else known["settings"].map(lambda s: float(s[key]))
    points = known.assign(size=size).drop_duplicates("size", keep="last")
    finest = np.log(points.nsmallest(2, "numerical")[["numerical", "size"]]).diff().abs().iloc[1:]
    ratios = list(finest["numerical"] / finest["size"])
    return Order(curve.label, key, ratios[0], curve.order) if ratios else None


def sentences(study: Study, table: pd.DataFrame) -> list[str]:
    """Return the findings of a study: measured orders and the number of failures; for a timed study
    also the cheapest point within each misfit, the cost of the next best curve and, if the finest
    physics is a fine run, its accuracy."""
    found: list[str] = []
    if study.timed and table["total"].notna().any():
        found += filter(None, (_cheapest(table, target) for target in TARGETS))
        if isinstance(study.finest, FineRun):
            found.append(
                f"The finest physics is a fine run of {study.finest.method}; a coarser one is "
                f"{percent(floor(table, 'total'))} % from it."
            )
    if failed := int((table["state"] == "failed").sum()):
        found.append(f"{failed} of {len(table)} points failed; they are listed in the table.")
    return [*found, *_equal_steps(study, table)] + [
        f"{one.curve}: measured order {one.measured:.2f} in {one.key}, theory {one.theory:g}."
        for one in orders(study, table)
    ]


def _equal_steps(study: Study, table: pd.DataFrame) -> Iterator[str]:
    """Yield curves of which points that differ in a step key alone have the same time step."""
    for curve in study.curves:
        points = table[table["curve"] == curve.label].dropna(subset="dt")
        for key in (key for key in curve.vary if "step" in key):
            rest = points["settings"].map(lambda of, key=key: repr(of | {key: None}))
            if same := int(points.assign(rest=rest).duplicated(["rest", "dt"], keep=False).sum()):
                yield (
                    f"{curve.label}: {same} of {len(points)} points have the time step of another "
                    f"one: {key} is rounded so that steps divide record.interval."
                )


def _cheapest(table: pd.DataFrame, target: float) -> str:
    within: list[Any] = list(cheapest(table, target).itertuples())
    if not within:
        return ""
    best, *others = within
    text = (
        f"Within {percent(target)} % of the finest physics the cheapest is {best.curve} "
        f"({_errors(best)}; {in_seconds(best.seconds)})"
    )
    if not others:
        return f"{text}; no other curve reaches it."
    times = f"{others[0].seconds / best.seconds:.3g} times as long"
    return f"{text}; the next best, {others[0].curve} ({_errors(others[0])}), steps {times}."


def _errors(point: Any) -> str:
    parts = f"numerical {percent(point.numerical)} % + modelling {percent(point.modelling)} %"
    return f"{parts} = {percent(point.total)} %"
