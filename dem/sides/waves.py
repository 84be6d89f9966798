"""Waves that enter through quiet sides, as forces on the blocks there, in any dimension."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from scipy.sparse import csr_array

from jointwave.cases.histories import LoadHistory, Step
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, tractions
from jointwave.cases.sampling import Clock
from jointwave.dem.sides.boundaries import BoundaryPoints, resultants, summed
from jointwave.dem.sides.loads import Source, mean_of

#: Samples of a field in a period of a pulse, where it is not evaluated at every step.
IN_A_PERIOD = 200


class Delayed:
    """Forces on points with a common history, each with its own delay.

    row : of each point [m]. unit : the resultants of a unit there [m, d + d^2]. history : with a
    mean over each step. late : s [m].
    """

    def __init__(
        self, row: np.ndarray, unit: np.ndarray, history: LoadHistory, late: np.ndarray
    ) -> None:
        self.row, self.unit, self.history, self.late = row, unit, history, late

    def at(self, steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        """See `loads.Source`."""
        own = np.flatnonzero(np.isin(self.row, rows))
        unit, size = self.unit[own] @ onto.T, len(onto)
        mean = mean_of(self.history, steps, dt, self.late[own, None])
        place = size * np.searchsorted(rows, self.row[own])[:, None] + np.arange(size)
        point = np.repeat(np.arange(len(own)), size)
        shape = size * len(rows), len(own)
        matrix = csr_array((unit.ravel(), (place.ravel(), point)), shape=shape)
        return np.ascontiguousarray((matrix @ mean).T).reshape(-1, len(rows), size)


class Sampled:
    """What a field does on rows at samples close enough to be interpolated: resultants
    [s, h, d + d^2] at times [s], s."""

    def __init__(self, times: np.ndarray, found: np.ndarray) -> None:
        self.samples = FaceTractions(times, found)

    def at(self, steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        """See `loads.Source`."""
        return self.samples.at(dt * steps, lambda found: found[:, rows] @ onto.T)


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
            Delayed(row, found(still, np.array([inf]))[0], one.pulse, one.lateness(points.place))
            for still, one in zip(unit, field.waves, strict=True)
        ]
    interval = min(time.dt * time.stride, (period or inf) / IN_A_PERIOD)
    times = interval * np.arange(int(np.ceil(time.dt * time.steps / interval)) + 4)
    return [Sampled(times, summed(found(field, times), row, len(rows)))]
