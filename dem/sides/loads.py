"""External forces on blocks, in any dimension, step by step."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import step_means
from jointwave.cases.sampling import Clock
from jointwave.dem.kernel.composition import instants
from jointwave.dem.sides.boundaries import points_on, resultants, summed

#: Samples times held blocks whose forces are in memory at a time.
AT_ONCE = 100_000
IN_A_PERIOD = 20  # samples of the forces per period of their highest frequency


class Pattern(NamedTuple):
    """Forces [m, d], N, at arms [m, d], m, on blocks [m], ascending, times a history (None: 1)."""

    block: np.ndarray
    arm: np.ndarray
    force: np.ndarray
    history: LoadHistory | None


#: A function of (steps, dt, rows, onto) for forces that are no pattern times a history: returns
#: onto [a, d + d^2] times the resultants in equally spaced steps [n] of dt, s, on held blocks
#: `rows` [k], ascending: [n, k, a].
Source = Callable[[np.ndarray, float, np.ndarray, np.ndarray], np.ndarray]


class Loads:
    """All forces on held blocks, step by step; resultants as in `dem.sides.boundaries`.

    rows : the block of each row [h], ascending. onto : `boundaries.freedoms`. composed : whether
    forces are values at the instants of `composition`, not means over steps.
    """

    def __init__(
        self,
        rows: np.ndarray,
        patterns: list[Pattern],
        waves: list[Source],
        time: Clock,
        onto: np.ndarray,
        composed: bool = False,
    ) -> None:
        self.rows, self.time, self.waves, self.onto = rows, time, waves, onto
        self.composed = composed
        self.histories = [one.history for one in patterns]
        self.shapes = np.zeros((len(patterns), len(rows), onto.shape[1]))
        for shape, one in zip(self.shapes, patterns, strict=True):
            row = np.searchsorted(rows, one.block)
            shape[:] = summed(resultants(one.arm, one.force), row, len(rows))

    def add_steady(self, shape: np.ndarray) -> None:
        """Add constant resultants [h, d + d^2]."""
        self.histories.append(None)
        self.shapes = np.concatenate([self.shapes, shape[None]])

    @property
    def steady(self) -> np.ndarray:
        """Constant forces and moments [h, F], N and N m."""
        own = [k for k, history in enumerate(self.histories) if history is None]
        return self.shapes[own].sum(axis=0) @ self.onto.T

    def resultants(self, steps: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return resultants in equally spaced steps [n] on held blocks `rows` [k], ascending
        [n, k, d + d^2]: means over each step, or values if composed."""
        return self._acting(steps, rows, np.eye(self.onto.shape[1]))

    def drive(self, steps: np.ndarray) -> np.ndarray:
        """Return forces and moments in equally spaced steps [n, h, F], or in their stages
        [n stages, h, F], N and N m."""
        return self._on_blocks(instants(steps) if self.composed else steps)

    def turned(self, steps: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Return the change of moments [n, h, 3], N m, as the arms of loads with a history rotate
        with their blocks; turn : R - 1 of each block [h, 3, 3]."""
        steady = self.shapes[[one is None for one in self.histories]].sum(axis=0)
        found = (self.resultants(steps, np.arange(len(self.rows))) - steady)[..., 3:]
        moved = turn @ found.reshape(*found.shape[:2], 3, 3)
        return moved.reshape(found.shape) @ self.onto[3:, 3:].T

    def _on_blocks(self, steps: np.ndarray) -> np.ndarray:
        return self._acting(steps, np.arange(len(self.rows)), self.onto)

    def _acting(self, steps: np.ndarray, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        means = np.ones((len(self.histories), len(steps)))
        for mean, history in zip(means, self.histories, strict=True):
            if history is not None and self.composed:
                mean[:] = history.value(self.time.dt * steps)
            elif history is not None:
                mean[:] = step_means(history, self.time.dt, steps)
        found = np.tensordot(means, self.shapes[:, rows] @ onto.T, axes=(0, 0))
        for wave in self.waves if len(steps) else ():
            found += wave(steps, self.time.dt, rows, onto)
        return found

    def impulse(self, inertia: np.ndarray, frequency: float | None) -> float:
        """Return a bound on the increase of sqrt(2 E) by all forces, sqrt(J), from their values at
        samples, or more often if samples are too far apart for the highest frequency.

        inertia : of each row's freedoms [h, F]. frequency : highest of the forces, Hz, or None.
        Constant forces do not count: they balance the prestress.
        """
        time = self.time
        periods = time.dt * time.stride * (frequency or 0.0)
        stride = max(1, int(time.stride / max(1.0, IN_A_PERIOD * periods)))
        steps = np.arange(0, time.stride * time.samples, stride)
        parts = -(-len(steps) * max(1, len(self.rows)) // AT_ONCE)
        felt = 0.0
        for some in np.array_split(steps, parts):
            forces = self._on_blocks(some) - self.steady
            felt += float(np.sqrt((forces**2 / inertia).sum(axis=(1, 2))).sum())
        return time.dt * stride * felt


def reactions(
    blocks: Blocks, facets: np.ndarray, stress: np.ndarray, along: bool = False
) -> Pattern:
    """Return the forces of the rock beyond boundary facets (indices) that balance a stress [d, d],
    Pa, compression positive; along : only the components along the facets."""
    points = points_on(blocks, facets)
    traction = -points.normal @ stress
    if along:
        traction -= (traction * points.normal).sum(axis=1)[:, None] * points.normal
    return Pattern(points.block, points.arm, points.area[:, None] * traction, None)
