"""Waves that enter through quiet sides, as forces on the blocks there, in any dimension."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from scipy.sparse import csr_array

from jointwave.cases.histories import LoadHistory, Step
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, tractions
from jointwave.cases.loads import step_means
from jointwave.cases.sampling import Clock
from jointwave.dem.sides.boundaries import BoundaryPoints, resultants, summed
from jointwave.dem.sides.loads import Source

#: Samples of a field in a period of a pulse, where it is not evaluated at every step.
IN_A_PERIOD = 200


def delayed(row: np.ndarray, unit: np.ndarray, history: LoadHistory, late: np.ndarray) -> Source:
    """Return forces on points with a common history, each with its own delay.

    row : of each point [m]. unit : the resultants of a unit there [m, d + d^2]. history : with a
    mean over each step. late : s [m].
    """

    def acting(steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        own, size = np.flatnonzero(np.isin(row, rows)), len(onto)
        mean = step_means(history, dt, steps, late[own, None])
        place = size * np.searchsorted(rows, row[own])[:, None] + np.arange(size)
        entries = (
            (unit[own] @ onto.T).ravel(),
            (place.ravel(), np.repeat(np.arange(len(own)), size)),
        )
        matrix = csr_array(entries, shape=(size * len(rows), len(own)))
        return np.ascontiguousarray((matrix @ mean).T).reshape(-1, len(rows), size)

    return acting


def incoming(
    field: IncidentField,
    period: float | None,
    points: BoundaryPoints,
    impedance: np.ndarray,
    rows: np.ndarray,
    time: Clock,
) -> list[Source]:
    """Return what a field does at the points of quiet sides.

    period : the shortest of its waves, s; None: none. impedance : of the dashpots there [m, d, d],
    Pa s/m. rows : held blocks [h]. Plane waves are known at every step; another field is asked
    once, at the samples of a run or more.
    """
    row = np.searchsorted(rows, points.block)

    def found(field: IncidentField, times: np.ndarray) -> np.ndarray:
        pulled = tractions(field, points.place, points.normal, impedance, times).values
        return resultants(points.arm, pulled * points.area[:, None])

    if isinstance(field, FreeField):
        unit = [FreeField((replace(one, pulse=Step(1.0)),)) for one in field.waves]
        return [
            delayed(row, found(still, np.array([inf]))[0], one.pulse, one.lateness(points.place))
            for still, one in zip(unit, field.waves, strict=True)
        ]
    interval = min(time.dt * time.stride, (period or inf) / IN_A_PERIOD)
    times = interval * np.arange(int(np.ceil(time.dt * time.steps / interval)) + 4)
    samples = FaceTractions(times, summed(found(field, times), row, len(rows)))
    return [
        lambda steps, dt, some, onto: samples.at(dt * steps, lambda all_: all_[:, some] @ onto.T)
    ]
