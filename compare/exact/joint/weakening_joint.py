"""What a joint passes of a plane shear wave where slip weakens it, by Runge-Kutta of order 8.

With the path S of the slip and the strength tau(S), that falls by h per path, the joint carries s:

    sticking: (Z / 2K) s' = sigma_I - s;   sliding along s: s = +-tau(S),
    (Z / 2) (1 - h / K) S' = |sigma_I| - tau(S),

each phase from where the one before ends: at |s| = tau(S), at S' = 0, at the end of the weakening.
Where 1/K = 0, s = sigma_I while it sticks. The slip u = s / K +- S gives the impulse of what
passes: that of sigma_I less Z u / 2.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cases.histories import LoadHistory

if TYPE_CHECKING:
    from compare.exact.joint.sliding_joint import SlipJoint

SPANS = 2000  # of the whole time, in each of which at most one phase ends
SHORTEST = 1e-12  # s, of a part of the time
NEAR = 1e-12  # of a strength: what two phases that meet may differ by


class Phase(NamedTuple):
    """start, end : s. way : +-1 where it slides, 0 where it sticks. path, slide : S and what has
    slid, signed, at its start, m. state : of time to s (Pa) or S (m); None where s = sigma_I."""

    start: float
    end: float
    way: int
    path: float
    slide: float
    state: Any


class Passed:
    """sigma_T (Pa) and its impulse (Pa s) at any times up to `end` (s), by the incident `load`.

    impedance : Z, Pa s/m. tolerance : of each step of the integration, relative.
    """

    def __init__(
        self, joint: "SlipJoint", impedance: float, load: LoadHistory, end: float, tolerance: float
    ) -> None:
        self.joint, self.impedance, self.load, self.tolerance = joint, impedance, load, tolerance
        first = load.breaks[0]
        edges = [*(t for t in load.breaks if t < end), max(end, first + SHORTEST)]
        self.span = (edges[-1] - first) / SPANS
        self.phases: list[Phase] = []
        for start, stop in pairwise(edges):
            while start < stop - SHORTEST:
                start = self._next(start, stop)

    def __call__(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return both at times (s)."""
        stress, slide = np.zeros(np.shape(times)), np.zeros(np.shape(times))
        for phase in self.phases:
            own = (times > phase.start) & (times <= phase.end)
            if own.any():
                stress[own], slide[own] = self._within(phase, times[own])
        if self.phases:
            later = times > self.phases[-1].end
            stress[later], slide[later] = self._within(self.phases[-1], self.phases[-1].end)
        slip = self.joint.compliance * stress + slide
        return stress, self.load.impulse(times) - self.impedance * slip / 2

    def _within(self, phase: Phase, t: Any) -> tuple[Any, Any]:
        """Return s and what has slid at times of a phase."""
        if phase.way:
            path = phase.state(t)[0]
            return phase.way * self.joint.left(path), phase.slide + phase.way * (path - phase.path)
        stress = self.load.value(np.asarray(t)) if phase.state is None else phase.state(t)[0]
        return stress, phase.slide

    def _next(self, start: float, stop: float) -> float:
        """Add the phase that begins at `start`, and return where it ends, by `stop`."""
        stress, path, slide = 0.0, 0.0, 0.0
        if self.phases:
            last = self.phases[-1]
            stress, slide = (float(x) for x in self._within(last, last.end))
            path = last.path + abs(slide - last.slide)
        incident = self._incident(start + SHORTEST)
        if self.joint.compliance == 0:
            stress = incident
        way = int(np.sign(stress))
        limit = self.joint.left(path)
        slides = abs(stress) >= limit * (1 - NEAR) and way * incident > limit
        if slides:
            phase = self._slide(start, stop, way, path, slide)
        else:
            phase = self._stick(start, stop, stress, path, slide)
        self.phases.append(phase)
        return phase.end

    def _incident(self, t: float) -> float:
        return float(self.load.value(np.array([t]))[0])

    def _stick(self, start: float, stop: float, stress: float, path: float, slide: float) -> Phase:
        joint, limit = self.joint, self.joint.left(path)
        if joint.compliance == 0:
            times = np.linspace(start + SHORTEST, stop, SPANS)
            beyond = np.flatnonzero(np.abs(self.load.value(times)) > limit)
            if beyond.size and beyond[0] > 0:
                stop = self._crossing(limit, *times[beyond[0] - 1 : beyond[0] + 1])
            return Phase(start, stop, 0, path, slide, None)
        relaxation = self.impedance * joint.compliance / 2

        def rate(t: float, s: np.ndarray) -> np.ndarray:
            return (self._incident(t) - s) / relaxation

        def yields(t: float, s: np.ndarray) -> float:
            return abs(float(s[0])) - limit

        found = self._solved(rate, start, stop, stress, limit, yields)
        return Phase(start, found.t[-1], 0, path, slide, found.sol)

    def _crossing(self, limit: float, before: float, after: float) -> float:
        from scipy.optimize import brentq

        return brentq(lambda t: abs(self._incident(t)) - limit, before, after, xtol=1e-16)

    def _slide(self, start: float, stop: float, way: int, path: float, slide: float) -> Phase:
        joint, z = self.joint, self.impedance
        weakens = path < joint.distance * (1 - NEAR)
        share = 1 - joint.compliance * joint.fall if weakens else 1.0

        def rate(t: float, s: np.ndarray) -> np.ndarray:
            return 2 * (way * self._incident(t) - joint.left(s)) / (z * share)

        def stops(t: float, s: np.ndarray) -> float:
            return float(rate(t, s)[0])

        def is_weak(t: float, s: np.ndarray) -> float:
            return float(s[0]) - joint.distance if weakens else -1.0

        scale = joint.distance if np.isfinite(joint.distance) else joint.strength / z * self.span
        found = self._solved(rate, start, stop, path, scale, stops, is_weak)
        return Phase(start, found.t[-1], way, path, slide, found.sol)

    def _solved(
        self, rate: Callable, start: float, stop: float, now: float, scale: float, *ends: Callable
    ) -> Any:
        """Return a phase from `now` on that ends where its events fall from above or rise to 0."""
        from scipy.integrate import solve_ivp

        for event in ends:
            event.terminal = True  # type: ignore[attr-defined]
            event.direction = -1 if event.__name__ == "stops" else 1  # type: ignore[attr-defined]
        return solve_ivp(
            rate, (start, stop), [now], "DOP853", events=ends, dense_output=True,
            max_step=self.span, rtol=self.tolerance, atol=self.tolerance * scale,
        )  # fmt: skip
