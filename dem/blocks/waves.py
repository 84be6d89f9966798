"""Waves that enter through quiet sides, as forces on the blocks there."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from scipy.sparse import csr_array

from jointwave.cases.histories import LoadHistory, Step
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, tractions
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.blocks.edges import EdgePoints, gathered, on_rows, resultant

#: Samples of a field in a period of a pulse, where it is not evaluated at every step.
IN_A_PERIOD = 200


class Delayed:
    """Forces on points with a common history, each with its own delay.

    row : of each point [m]. sums : what a unit does there as `edges.gathered` has it [m, 6].
    history : with a mean over each step. late : s [m].
    """

    def __init__(
        self, row: np.ndarray, sums: np.ndarray, history: LoadHistory, late: np.ndarray
    ) -> None:
        self.row, self.sums_of, self.history, self.late = row, sums, history, late
        self.forces_of = resultant(sums)

    def sums(self, steps: np.ndarray, dt: float, rows: np.ndarray) -> np.ndarray:
        """Return the resultants in steps [n] of dt, s, on rows [k], ascending: [n, k, 6]."""
        own = np.flatnonzero(np.isin(self.row, rows))
        here = dt * steps[:, None] - self.late[own]
        mean = (self.history.impulse(here + dt / 2) - self.history.impulse(here - dt / 2)) / dt
        place = np.searchsorted(rows, self.row[own])
        return on_rows(mean[..., None] * self.sums_of[own], place, len(rows))

    def at(self, steps: np.ndarray, dt: float, count: int) -> np.ndarray:
        """Return forces and moments in steps [n] of dt, s: [n, count, 3]."""
        return resultant(self.sums(steps, dt, np.arange(count)))

    def drive(self, first: int, last: int, dt: float, count: int) -> np.ndarray:
        """Return forces and moments in the steps first .. last - 1 [n, count, 3]."""
        edges = dt * (np.arange(first, last + 1) - 0.5)
        mean = np.diff(self.history.impulse(edges - self.late[:, None]), axis=1) / dt
        place = 3 * self.row[:, None] + np.arange(3)
        point = np.repeat(np.arange(len(self.row)), 3)
        shape = 3 * count, len(self.row)
        matrix = csr_array((self.forces_of.ravel(), (place.ravel(), point)), shape=shape)
        return np.ascontiguousarray((matrix @ mean).T).reshape(-1, count, 3)


class Sampled:
    """What a field does on rows as `edges.gathered` has it, at samples close enough to be
    interpolated: sums [s, h, 6] at times [s], s."""

    def __init__(self, times: np.ndarray, sums: np.ndarray) -> None:
        self.times, self.sums_of = times, sums
        self.forces = FaceTractions(times, resultant(sums))

    def sums(self, steps: np.ndarray, dt: float, rows: np.ndarray) -> np.ndarray:
        """Return the resultants in equally spaced steps [n] of dt, s, on rows [k]: [n, k, 6]."""
        return FaceTractions(self.times, self.sums_of[:, rows]).at(dt * steps)

    def at(self, steps: np.ndarray, dt: float, count: int) -> np.ndarray:
        """Return forces and moments in equally spaced steps [n] of dt, s: [n, h, 3]."""
        return self.forces.at(dt * steps)

    def drive(self, first: int, last: int, dt: float, count: int) -> np.ndarray:
        """Return forces and moments in the steps first .. last - 1 [n, h, 3]."""
        return self.at(np.arange(first, last), dt, count)


def incoming(
    scene: RockMass,
    field: IncidentField,
    points: EdgePoints,
    impedance: np.ndarray,
    rows: np.ndarray,
    time: Clock,
) -> list[Delayed | Sampled]:
    """Return what a field does at the points of quiet edges; nothing of a scene without waves.

    impedance : of the dashpots there [m, 2], Pa s/m. rows : held blocks [h]. Plane waves are known
    at every step; another field is asked once, at the samples of a run or more.
    """
    if not scene.waves or not len(points.block):
        return []
    row = np.searchsorted(rows, points.block)

    def sums(field: IncidentField, times: np.ndarray) -> np.ndarray:
        found = tractions(field, points.place, points.normal, impedance, times).values
        return gathered(points.arm, found * points.length[:, None])

    if isinstance(field, FreeField):
        found: list[Delayed | Sampled] = []
        for wave in field.waves:
            unit = FreeField((replace(wave, pulse=Step(1.0)),))  # 1 eventually
            (shape,) = sums(unit, np.array([inf]))
            found.append(Delayed(row, shape, wave.pulse, wave.lateness(points.place)))
        return found
    period = shortest_period(scene.waves) or inf
    interval = min(time.dt * time.stride, period / IN_A_PERIOD)
    times = interval * np.arange(int(np.ceil(time.dt * time.steps / interval)) + 4)
    return [Sampled(times, on_rows(sums(field, times), row, len(rows)))]
