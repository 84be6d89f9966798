"""Integration by Runge-Kutta of order 8 (Dormand & Prince) between the breaks of a load."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from jointwave.cases.errors import UnstableError
from jointwave.cases.histories import LoadHistory

SAMPLES = 2001  # of a load, to find its peak
SHORTEST = 1e-12  # s, shortest interval of integration
MOST = 2e5  # time constants of a joint, which take a minute to integrate


def too_stiff(compliance: float, impedance: float, duration: float) -> tuple[bool, str]:
    """Return whether a joint of a compliance 1/K (m/Pa; 0 if rigid) takes too long to integrate
    over a duration (s) in rock of an impedance Z (Pa s/m), and the reason, for `Answer.unless`."""
    times = 2 * duration / (compliance * impedance) if compliance > 0 else 0.0
    return times > MOST, f"the joint is too stiff: the scene lasts {times:.2g} times its Z / 2K"


def edges_of(load: LoadHistory, end: float) -> list[float]:
    """Return the breaks of a load up to `end`, and `end`, s."""
    return [*(t for t in load.breaks if t < end), max(end, load.breaks[0] + SHORTEST)]


def peak_of(load: LoadHistory, end: float) -> float:
    """Return the largest magnitude of a load up to `end` (s)."""
    times = np.linspace(load.breaks[0], max(end, load.breaks[0] + SHORTEST), SAMPLES)
    return float(np.abs(load.value(times)).max())


class Trajectory:
    """The solution of x' = rate(t, x) at any time, from the state `start` [m] at the first edge.

    tolerance : of each step, relative. scale : size of the state, float array [m] or float. Raises
    UnstableError where the state jumps, as at a joint whose friction falls faster than it unloads.
    """

    def __init__(
        self,
        rate: Callable[[float, np.ndarray], Any],
        start: Sequence[float],
        edges: Sequence[float],
        tolerance: float,
        scale: np.ndarray | float,
        longest: float = np.inf,
    ) -> None:
        from scipy.integrate import solve_ivp

        self.start, self._parts = np.array(start), []
        now, steps = self.start, {"max_step": longest, "rtol": tolerance}
        for part in pairwise(edges):
            with np.errstate(over="ignore", invalid="ignore"):  # in trial steps that are too long
                found = solve_ivp(
                    rate, part, now, "DOP853", dense_output=True, atol=tolerance * scale, **steps
                )
            if not found.success:
                raise UnstableError(f"the joint snaps {found.t[-1]:.4g} s after the wave meets it")
            self._parts.append((*part, found.sol))
            now = found.y[:, -1]

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """Return the states [m, n] at times [n] (s)."""
        found = np.multiply.outer(self.start, np.ones(np.shape(times)))
        for first, last, solution in self._parts:
            own = (times > first) & (times <= last)
            if own.any():
                found[:, own] = solution(times[own])
        return found
