"""External forces on blocks: waves at quiet sides, pressures, forces, a static stress."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import velocity_of
from jointwave.cases.material.quiet_sides import base_traction, impedances
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.locate import block_at
from jointwave.cases.partition.parts import loaded_part
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.plane import InSituStress
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.dem.blocks.edges import gathered, on_rows, points_on, resultant
from jointwave.dem.blocks.waves import Delayed, Sampled

#: Samples times held blocks whose forces are there at once.
AT_ONCE = 100_000
IN_A_PERIOD = 20  # samples of the forces per period of their highest frequency


class Pattern(NamedTuple):
    """A force pattern: forces [m, 2], N, at arms [m, 2] on blocks [m], times a history; None:
    constant."""

    block: np.ndarray
    arm: np.ndarray
    force: np.ndarray
    history: LoadHistory | None


class Sources:
    """All forces on held blocks, step by step.

    rows : int array [h], the block of each row.
    """

    def __init__(
        self,
        rows: np.ndarray,
        patterns: list[Pattern],
        waves: list[Delayed | Sampled],
        time: Clock,
    ) -> None:
        self.rows, self.time, self.waves = rows, time, waves
        self.histories = [one.history for one in patterns]
        self.shapes = np.array(
            [
                on_rows(gathered(one.arm, one.force), np.searchsorted(rows, one.block), len(rows))
                for one in patterns
            ]
        ).reshape(len(patterns), len(rows), 6)

    def add_steady(self, sums: np.ndarray) -> None:
        """Add forces that act all the time, as `edges.gathered` has them [h, 6]."""
        self.histories.append(None)
        self.shapes = np.concatenate([self.shapes, sums[None]])

    @property
    def steady(self) -> np.ndarray:
        """Constant forces and moments [h, 3], N and N m."""
        own = [k for k, history in enumerate(self.histories) if history is None]
        return resultant(self.shapes[own].sum(axis=0))

    def sums(self, steps: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return what acts on some rows [k], ascending, in equally spaced steps [n], as
        `edges.gathered` has it: [n, k, 6]."""
        found = np.zeros((len(steps), len(rows), 6))
        self._add_patterns(found, steps, self.shapes[:, rows])
        for one in self.waves:
            found += one.sums(steps, self.time.dt, rows)
        return found

    def drive(self, first: int, last: int) -> np.ndarray:
        """Return forces and moments in the steps first .. last - 1 [n, h, 3], N and N m."""
        found = np.zeros((last - first, len(self.rows), 3))
        if last > first:
            self._add_patterns(found, np.arange(first, last), resultant(self.shapes))
            for one in self.waves:
                found += one.drive(first, last, self.time.dt, len(self.rows))
        return found

    def _at(self, steps: np.ndarray) -> np.ndarray:
        """Return forces and moments in equally spaced steps [n, h, 3], N and N m."""
        found = np.zeros((len(steps), len(self.rows), 3))
        self._add_patterns(found, steps, resultant(self.shapes))
        for one in self.waves:
            found += one.at(steps, self.time.dt, len(self.rows))
        return found

    def _add_patterns(self, found: np.ndarray, steps: np.ndarray, shapes: np.ndarray) -> None:
        """Add the mean of every pattern over each step."""
        dt = self.time.dt
        for shape, history in zip(shapes, self.histories, strict=True):
            if history is None:
                found += shape
            else:
                impulses = history.impulse(dt * (steps + 0.5)) - history.impulse(dt * (steps - 0.5))
                found += (impulses / dt)[:, None, None] * shape

    def impulse(self, inertia: np.ndarray, frequency: float | None) -> float:
        """Return a bound on what all of it adds to sqrt(2 E), sqrt(J), sample by sample, or more
        often where samples are too rare to see it.

        inertia : of each row's freedoms [h, 3]. frequency : the highest that acts, Hz; None: none.
        What is steady acts from the start, and is in equilibrium with the stress that it stands
        for.
        """
        time = self.time
        periods = time.dt * time.stride * (frequency or 0.0)
        stride = max(1, int(time.stride / max(1.0, IN_A_PERIOD * periods)))
        steps = np.arange(0, time.stride * time.samples, stride)
        parts = -(-len(steps) * max(1, len(self.rows)) // AT_ONCE)
        felt = 0.0
        for some in np.array_split(steps, parts):
            forces = self._at(some) - self.steady
            felt += float(np.sqrt((forces**2 / inertia).sum(axis=(1, 2))).sum())
        return time.dt * stride * felt


def reactions(partition: Partition, sides: list[str], stress: InSituStress) -> Pattern:
    """Return the forces by which the rock beyond some sides goes on to bear a stress."""
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
    """Return a pressure, a force or a compliant base of a scene."""
    history = velocity_of(load, load.amplitude)
    if load.kind == "force":
        at = np.array([load.at])
        block = block_at(partition, at)
        return Pattern(block, at - partition.centroid[block], np.array([load.direction]), history)
    chosen, part = loaded_part(scene, partition, load)
    points = points_on(partition, partition.boundary, chosen, part)
    if load.kind == "base":
        assert load.direction is not None
        impedance = impedances(scene, points.normal, partition.region[points.block])
        traction = base_traction(points.normal, impedance, load.direction)
    else:
        traction = -points.normal
    return Pattern(points.block, points.arm, points.length[:, None] * traction, history)
