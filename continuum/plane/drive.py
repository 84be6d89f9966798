"""Forces that each have a history of their own: loads, and waves that enter through quiet sides.

They are worked out for some steps at a time, in a buffer of bounded size.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError
from jointwave.cases.histories import LoadHistory
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, tractions
from jointwave.cases.loads import step_means
from jointwave.cases.material.quiet_sides import medium_impedances
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.parallel.serial import Serial
from jointwave.continuum.plane.sides import SidePoints
from jointwave.continuum.space.body import Body

BUFFER = 500_000  # numbers in the buffer, at most, but for one step
SAMPLES = 40_000_000  # numbers of a field that is sampled beforehand, at most
IN_INTERVAL = 1e-2  # of the period: how far such samples are apart, at most


class Push(NamedTuple):
    """A load: share [freedoms] times the mean of its history over a step, N/m."""

    share: np.ndarray
    history: LoadHistory


class Drive:
    """All forces on the rock that are known before a run.

    Attributes
    ----------
    freedom : int array [k]. force : float array [rows, k], N/m; that of step n in row n mod rows.
    """

    def __init__(self, body: Body, dt: float, pushes: list[Push], entry: Entry | None) -> None:
        shares = np.array([push.share for push in pushes]).reshape(len(pushes), body.mass.size)
        acts = (shares != 0).any(axis=0)
        if entry is not None:
            acts[entry.freedom] = True
        self.freedom = np.flatnonzero(acts)
        self.dt, self.entry, self.communicator = dt, entry, body.communicator
        self.pushes = [push._replace(share=push.share[self.freedom]) for push in pushes]
        rows = int(np.clip(BUFFER // max(1, self.freedom.size), 1, 4096))
        self.force = np.zeros((rows, self.freedom.size))
        if entry is not None:
            number = np.full(body.mass.size, -1)
            number[self.freedom] = np.arange(self.freedom.size)
            self.onto = entry.onto(number, self.freedom.size)

    def filled(self, first: int, last: int) -> Iterator[tuple[int, int]]:
        """Yield the parts of steps first .. last - 1 whose forces the buffer holds meanwhile."""
        rows = len(self.force)
        for begin in range(first, max(last, first + 1), rows):
            end = min(begin + rows, last)
            if end > begin:
                self.force[np.arange(begin, end) % rows] = self.at(begin, end)
            yield begin, end

    def at(self, first: int, last: int) -> np.ndarray:
        """Return the forces of steps first .. last - 1 [steps, k], N/m."""
        found = np.zeros((last - first, self.freedom.size))
        for push in self.pushes:
            mean = step_means(push.history, self.dt, last - first, first)
            found += mean[:, None] * push.share
        if self.entry is not None:
            values = self.entry.tractions(self.dt * np.arange(first, last))
            found += values.reshape(len(values), -1) @ self.onto
        return found

    def impulse(self, mass: np.ndarray, steps: int) -> float:
        """Return a bound on the integral over all steps of |F| in the norm of 1 / m,
        sqrt(kg) m/s; of waves by one step in a few, with a margin for what is between."""
        per_step, whole = 0.0, self.communicator.sum
        for push in self.pushes:
            mean = step_means(push.history, self.dt, steps + 1)
            size = np.sqrt(whole((push.share**2 / mass[self.freedom]).sum()))
            per_step += float(np.abs(mean).sum() * size)
        if self.entry is not None:
            largest = np.sqrt(whole(self.entry.largest(mass, self.dt * steps) ** 2))
            per_step += largest / self.dt * steps
        return self.dt * per_step


class Entry:
    """A field that enters through quiet sides.

    Attributes
    ----------
    freedom : int array [2 points], x of all points, then y.
    """

    def __init__(
        self, scene: RockMass, body: Body, points: SidePoints, field: IncidentField
    ) -> None:
        self.points = points
        self.freedom = body.freedom(self.points.node[:, None], np.arange(2)).T.ravel()
        self.field, self.duration = field, scene.time.duration
        self.impedance = medium_impedances(scene, self.points.normal, self.points.region)
        self.sampled = None
        if not isinstance(field, FreeField):
            self.sampled = self._sampled(scene, body.communicator)

    def _sampled(self, scene: RockMass, communicator: Serial) -> FaceTractions:
        """Return the tractions of a field that is evaluated once for all times.

        It is asked for the points of all processes, since what it makes of some may depend on which
        others they are asked with.
        """
        own = self.points.x, self.points.normal, self.impedance
        every, here = communicator.beside(np.concatenate(own, axis=1))
        period = shortest_period(scene.waves) or self.duration
        apart = min(scene.interval, IN_INTERVAL * period)
        count = int(np.ceil(self.duration / apart)) + 8
        if 2 * count * len(every) > SAMPLES:
            allowed = (
                f"gives {count:,} samples of incident waves at {len(every):,} points of quiet "
                f"sides; at most {SAMPLES:.0e} numbers: larger elements (numerics.continuum.size)"
            )
            raise SceneError(scene.where, "time.duration", self.duration, allowed)
        times = apart * np.arange(count)
        found = tractions(self.field, every[:, :2], every[:, 2:4], every[:, 4:], times).values
        return FaceTractions(times, found[:, here].copy())

    def tractions(self, times: np.ndarray) -> np.ndarray:
        """Return the tractions at equally spaced times [n, points, 2], Pa."""
        if self.sampled is not None:
            return self.sampled.at(times)
        own = self.points
        return tractions(self.field, own.x, own.normal, self.impedance, times).values

    def onto(self, number: np.ndarray, count: int) -> csr_matrix:
        """Return what makes forces [count] of tractions [points * 2]; number : int array, of each
        freedom among those that are driven."""
        many = len(self.points.x)
        row = np.arange(2 * many).reshape(many, 2).T.ravel()
        weight = np.tile(self.points.weight, 2)
        return csr_matrix((weight, (row, number[self.freedom])), (2 * many, count))

    def largest(self, mass: np.ndarray, duration: float) -> float:
        """Return about twice the largest |F| in the norm of 1 / m at any time."""
        if self.sampled is None:
            values = self.tractions(np.linspace(0.0, duration, 400))
        else:
            values = self.sampled.values
        of = self.points.weight**2 / mass[self.freedom[: len(self.points.x)]]
        return 2.0 * float(np.sqrt(np.einsum("p,npc,npc->n", of, values, values).max(initial=0.0)))
