"""What acts on blocks from outside: waves at quiet sides, pressures, forces, a steady stress."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.incident import FreeField, IncidentField, enters, tractions
from cases.loads import history_of
from cases.partition.blocks import Partition
from cases.partition.locate import block_at
from dem.blocks.edges import EdgePoints, gathered, on_rows, points_on, resultant
from dem.blocks.parts import loaded_part

if TYPE_CHECKING:
    from cases.loads import LoadHistory
    from cases.sampling import Clock
    from cases.schema.plane import StressInPlane
    from cases.schema.rock_mass import RockMass
    from cases.schema.sources import PlaneLoad

#: Samples of a field in a period of a pulse, where it is not evaluated at every step.
IN_A_PERIOD = 200


class Pattern(NamedTuple):
    """Forces that keep their shape: forces [m, 2], N, at arms [m, 2] on blocks [m], times a
    history; None: they are steady."""

    block: np.ndarray
    arm: np.ndarray
    force: np.ndarray
    history: LoadHistory | None


class Incoming(NamedTuple):
    """A field of waves at points of quiet edges, of these impedances [m, 2], Pa s/m; period : the
    shortest of its pulses, s."""

    points: EdgePoints
    impedance: np.ndarray
    field: IncidentField
    period: float


class Sources:
    """All that acts on held blocks, step by step.

    rows : int array [h], the block of each row.
    """

    def __init__(
        self, rows: np.ndarray, patterns: list[Pattern], incoming: Incoming | None, time: Clock
    ) -> None:
        self.rows, self.time, count = rows, time, len(rows)
        self.histories = [one.history for one in patterns]
        self.shapes = np.array(
            [
                on_rows(gathered(one.arm, one.force), np.searchsorted(rows, one.block), count)
                for one in patterns
            ]
        ).reshape(len(patterns), count, 6)
        self.incoming = incoming
        if incoming is not None:
            self._row = np.searchsorted(rows, incoming.points.block)
            self._tractions = _tractions_over_time(incoming, time)

    @property
    def steady(self) -> np.ndarray:
        """Forces and moments that do not change [h, 3], N and N m."""
        own = [k for k, history in enumerate(self.histories) if history is None]
        return resultant(self.shapes[own].sum(axis=0))

    def sums(self, steps: np.ndarray) -> np.ndarray:
        """Return what acts in equally spaced steps [n] as `edges.gathered` has it, [n, h, 6]."""
        dt, found = self.time.dt, np.zeros((len(steps), len(self.rows), 6))
        for shape, history in zip(self.shapes, self.histories, strict=True):
            if history is None:
                found += shape
            else:
                impulses = history.impulse(dt * (steps + 0.5)) - history.impulse(dt * (steps - 0.5))
                found += (impulses / dt)[:, None, None] * shape
        if self.incoming is not None and len(steps):
            points = self.incoming.points
            forces = self._tractions(dt * steps) * points.length[:, None]
            found += on_rows(gathered(points.arm, forces), self._row, len(self.rows))
        return found

    def drive(self, first: int, last: int) -> np.ndarray:
        """Return forces and moments in the steps first .. last - 1 [n, h, 3], N and N m."""
        return resultant(self.sums(np.arange(first, last)))

    def impulse(self, inertia: np.ndarray) -> float:
        """Return a bound on what all of it adds to sqrt(2 E), sqrt(J), sample by sample.

        inertia : of each row's freedoms [h, 3]. What is steady acts from the start, and is in
        equilibrium with the stress that it stands for.
        """
        steps = self.time.stride * np.arange(self.time.samples)
        forces = resultant(self.sums(steps)) - self.steady
        felt = np.sqrt((forces**2 / inertia).sum(axis=(1, 2)))
        return float(self.time.dt * self.time.stride * felt.sum())


def _tractions_over_time(one: Incoming, time: Clock) -> Callable[[np.ndarray], np.ndarray]:
    """Return what gives the tractions of a field at times [n]: [n, m, 2], Pa.

    Plane waves are evaluated at every step. Another field is asked once, for samples that are close
    enough to be interpolated.
    """
    points = one.points

    def at(times: np.ndarray) -> np.ndarray:
        return tractions(one.field, points.place, points.normal, one.impedance, times).values

    if isinstance(one.field, FreeField):
        return at
    interval = min(time.dt * time.stride, one.period / IN_A_PERIOD)
    times = interval * np.arange(int(np.ceil(time.dt * time.steps / interval)) + 4)
    return tractions(one.field, points.place, points.normal, one.impedance, times).at


def incoming(
    scene: RockMass, field: IncidentField, points: EdgePoints, impedance: np.ndarray
) -> Incoming | None:
    """Return a field at those points of quiet edges that it enters through; None of none."""
    enter = enters(field, scene, points.normal)
    if not enter.any():
        return None
    period = min((one.period for one in scene.waves if one.period), default=inf)
    own = EdgePoints(*(values[enter] for values in points))
    return Incoming(own, impedance[enter], field, period)


def reactions(partition: Partition, sides: list[str], stress: StressInPlane) -> Pattern:
    """Return the forces by which what lies beyond some sides holds a stress in equilibrium."""
    edges = partition.boundary
    points = points_on(partition, edges, on_sides(partition, sides))
    tensor = np.array([[stress.xx, stress.xy], [stress.xy, stress.yy]])
    force = -points.length[:, None] * (points.normal @ tensor)
    return Pattern(points.block, points.arm, force, None)


def on_sides(partition: Partition, sides: list[str]) -> np.ndarray:
    """Return which boundary edges lie on some sides, bool array [b]."""
    chosen = [k for k, name in enumerate(partition.sides) if name in sides]
    return np.isin(partition.boundary.side, chosen)


def load_pattern(scene: RockMass, partition: Partition, load: PlaneLoad) -> Pattern:
    """Return a pressure or a force of a scene."""
    history = history_of(load, load.amplitude)
    if load.kind == "force":
        at = np.array([load.at])
        block = block_at(partition, at)
        return Pattern(block, at - partition.centroid[block], np.array([load.direction]), history)
    chosen, part = loaded_part(scene, partition, load)
    points = points_on(partition, partition.boundary, chosen, part)
    return Pattern(points.block, points.arm, -points.length[:, None] * points.normal, history)
