"""A plane shear wave at a joint that slips, by Runge-Kutta of order 8 from phase to phase.

With the slip path S and the strength tau(S), which falls by h per unit of path or is constant, the
joint carries s:

    sticking: (Z / 2K) s' = sigma_I - s;   sliding along s: s = +-tau(S),
    (Z / 2) (1 - h / K) S' = |sigma_I| - tau(S).

A phase ends at |s| = tau(S), at S' = 0, or at the end of weakening. For 1/K = 0, s = sigma_I while
the joint sticks. The slip u = s / K +- S gives the transmitted impulse: that of sigma_I minus Z u /
2.

With an initial shear stress s_0, sigma_I + s_0 replaces sigma_I, and s includes s_0. A P wave that
adds the pressure p(t) raises tau by mu(S) p; while the joint slides

    (Z / 2) ((1 - h / K) S' + mu p' / K) = |sigma_I + s_0| - tau.

A joint that loses cohesion at its first slip keeps u: its path starts with the unloading.

A joint with 1/K = 0 that dilates by w(S) radiates a P wave of pressure p = (Z_n / 2) w'(S) S' to
both sides, with the normal impedance Z_n, and its strength rises by mu(S) p:

    (Z / 2 + mu w' Z_n / 2) S' = |sigma_I| - tau(S);   the impulse of p is Z_n w / 2.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory
from jointwave.compare.exact.joint.trajectory import SHORTEST, edges_of, peak_of

TOLERANCES = 3e-14, 1e-11  # for the integration and its twin
#: Parts of the whole time in which at most one phase ends; prime, since solve_ivp fails if a phase
#: ends exactly with a step.
SPANS = 1999
NEAR = 1e-12  # remainder of the weakening distance that is neglected, relative
TINY = 1e-300  # m, the path of a joint that has just slipped
#: Relative to the peak: by how much s may fall short of the strength when slip starts, and exceed
#: it while sticking, so that a phase that begins at the strength does not end there.
SHORT, BEYOND = 1e-11, 1e-14


class SlipJoint(NamedTuple):
    """A joint: y (m), additional compliance 1/K (m/Pa), strength tau (Pa), dynamic strength (Pa)
    and the slip path (m) over which it is reached.

    friction, dynamic_friction : tan(phi) of both. dilation, dilation_distance : initial tan(psi),
    and the slip path (m) over which it falls to 0. carried : s_0, Pa. lost : cohesion lost at the
    first slip, Pa.
    """

    y: float
    compliance: float
    strength: float
    dynamic: float = 0.0
    distance: float = inf
    friction: float = 0.0
    dynamic_friction: float = 0.0
    dilation: float = 0.0
    dilation_distance: float = inf
    carried: float = 0.0
    lost: float = 0.0

    @property
    def fall(self) -> float:
        """Loss of strength per slip path, Pa/m."""
        return (self.strength - self.dynamic) / self.distance

    def left(self, path: Any) -> Any:
        """Return the strength (Pa) after a slip path (m)."""
        whole = self.strength - self.lost * np.sign(path)
        return whole - self.fall * np.minimum(path, self.distance)

    def friction_at(self, path: Any) -> Any:
        """Return tan(phi) after a slip path (m)."""
        return self.friction - self.friction_fall * np.minimum(path, self.distance)

    @property
    def friction_fall(self) -> float:
        """Loss of tan(phi) per slip path, 1/m."""
        return (self.friction - self.dynamic_friction) / self.distance

    def lift(self, path: Any) -> Any:
        """Return the opening of the joint by dilation after a slip path (m), m."""
        way = np.minimum(path, self.dilation_distance)
        return self.dilation * way * (1 - way / self.dilation_distance / 2)

    def lift_rate(self, path: Any) -> Any:
        """Return the derivative of `lift` with respect to the path."""
        return self.dilation * np.maximum(1 - path / self.dilation_distance, 0.0)


class Phase(NamedTuple):
    """start, end : s. way : +-1 sliding, 0 sticking. path, slide : S and the signed slip at its
    start, m. state : s (Pa) or S (m) as a function of time; None if s = sigma_I."""

    start: float
    end: float
    way: int
    path: float
    slide: float
    state: Any


class Pressed(NamedTuple):
    """Pressure of a P wave on a joint: `of` gives p (Pa), p' (Pa/s) at times (s); its breaks, s."""

    of: Callable[[Any], tuple[Any, Any]] = lambda t: (0.0, 0.0)
    breaks: Sequence[float] = ()


class Passed:
    """sigma_T (Pa) and its impulse (Pa s) at any time up to `end` (s), under the incident `load`.

    impedance : Z, Pa s/m. tolerance : of each integration step, relative. normal_impedance : Z_n,
    Pa s/m, for a joint that dilates. pressed : by a P wave.
    """

    def __init__(
        self,
        joint: SlipJoint,
        impedance: float,
        load: LoadHistory,
        end: float,
        tolerance: float,
        normal_impedance: float = 0.0,
        pressed: Pressed = Pressed(),  # noqa: B008, has no state
    ) -> None:
        self.joint, self.impedance, self.load, self.tolerance = joint, impedance, load, tolerance
        self.normal_impedance, self.pressed = normal_impedance, pressed.of
        edges = edges_of(load, end)
        edges = sorted({*edges, *(t for t in pressed.breaks if t < edges[-1])})
        self.peak = peak_of(load, end) + abs(joint.carried)
        self.span = (edges[-1] - edges[0]) / SPANS
        self.phases: list[Phase] = []
        for start, stop in pairwise(edges):
            while start < stop - 2 * SHORTEST:
                start = self._next(start, stop)

    def __call__(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_T (Pa) and its impulse (Pa s) at times (s)."""
        stress, slide, _, _ = self._at(times)
        stress = stress - self.joint.carried
        slip = self.joint.compliance * stress + slide
        return stress, self.load.impulse(times) - self.impedance * slip / 2

    def pressure(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the pressure p of dilation (Pa) and its impulse (Pa s) at times (s)."""
        _, _, path, pressure = self._at(times)
        return pressure, self.normal_impedance * self.joint.lift(path) / 2

    def _at(self, times: np.ndarray) -> np.ndarray:
        """Return s, the signed slip, S and the pressure p of dilation at times [4, n]."""
        found = np.zeros((4, *np.shape(times)))
        found[0] = self.joint.carried
        # Each phase extends to the start of the next, though it may end slightly before.
        ends = [*(phase.start for phase in self.phases[1:]), inf]
        for phase, end in zip(self.phases, ends, strict=True):
            own = (times > phase.start) & (times <= end)
            if own.any():
                found[:, own] = self._within(phase, np.minimum(times[own], phase.end))
        return found

    def _within(self, phase: Phase, t: np.ndarray) -> np.ndarray:
        """Return s, signed slip, S and the pressure p of dilation at times of a phase [4, n]."""
        none = np.zeros(np.shape(t))
        if not phase.way:
            stress = self._incident(t) if phase.state is None else phase.state(t)[0]
            return np.array([stress, none + phase.slide, none + phase.path, none])
        path, pressure = phase.state(t)[0], none
        if self.joint.dilation:
            rate = self._rate(t, phase.way, path, False)
            pressure = self.normal_impedance / 2 * self.joint.lift_rate(path) * rate
        stress = self._strength(t, path) + self.joint.friction_at(path) * pressure
        slide = phase.slide + phase.way * (path - phase.path)
        return np.array([phase.way * stress, slide, path, pressure])

    def _incident(self, t: Any) -> Any:
        """Return sigma_I + s_0 at a time or times (s), Pa."""
        return self.load.value(np.asarray(t)) + self.joint.carried

    def _strength(self, t: Any, path: Any) -> Any:
        """Return tau (Pa) at times (s) after slip paths (m), without the effect of dilation."""
        return self.joint.left(path) + self.joint.friction_at(path) * self.pressed(t)[0]

    def _share(self, pressed: Any, weakens: bool) -> Any:
        """Return 1 - h / K under the pressure p (Pa)."""
        fall = self.joint.fall + self.joint.friction_fall * pressed
        return 1 - self.joint.compliance * fall if weakens else 1.0

    def _rate(self, t: Any, way: int, path: Any, weakens: bool) -> Any:
        """Return S' at times (s) while the joint slides."""
        joint, (pressed, rises) = self.joint, self.pressed(t)
        friction = joint.friction_at(path)
        resistance = self.impedance * self._share(pressed, weakens)
        if joint.dilation:
            resistance = resistance + friction * joint.lift_rate(path) * self.normal_impedance
        over = 2 * (way * self._incident(t) - joint.left(path) - friction * pressed)
        return (over - self.impedance * joint.compliance * friction * rises) / resistance

    def _weakens(self, path: float) -> bool:
        """Return whether slip beyond this path (m) reduces the strength."""
        return bool(self.joint.fall) and path < self.joint.distance * (1 - NEAR)

    def _next(self, start: float, stop: float) -> float:
        """Add the phase that begins at `start`, and return its end, at most `stop`."""
        stress, path, slide = self.joint.carried, 0.0, 0.0
        if self.phases:
            last = self.phases[-1]
            stress, slide, path, _ = self._within(last, np.array([last.end]))[:, 0].tolist()
        soon = start + SHORTEST
        limit = float(np.squeeze(self._strength(start, path)))
        if self.joint.compliance == 0 or limit == 0:
            stress = float(self._incident(soon))
        way, weakens = int(np.sign(stress)), self._weakens(path)
        slides = abs(stress) >= limit - SHORT * self.peak
        if slides and np.squeeze(self._rate(soon, way, path, weakens)) > 0:
            phase = self._slide(start, stop, way, path, slide)
        else:
            phase = self._stick(start, stop, stress, path, slide)
        if phase.end <= start:  # rounding: the previous phase continues
            return start + SHORTEST
        self.phases.append(phase)
        return phase.end

    def _stick(self, start: float, stop: float, stress: float, path: float, slide: float) -> Phase:
        from scipy.optimize import brentq

        joint = self.joint

        def excess(t: Any) -> Any:
            return np.squeeze(np.abs(self._incident(t)) - self._strength(t, path))

        if joint.compliance == 0 or joint.left(path) == 0:
            times = np.linspace(start + SHORTEST, stop, SPANS)
            beyond = np.flatnonzero(excess(times) > 0)
            if beyond.size and beyond[0] > 0:
                stop = brentq(excess, *times[beyond[0] - 1 : beyond[0] + 1], xtol=1e-16)
            return Phase(start, stop, 0, path, slide, None)
        relaxation = self.impedance * joint.compliance / 2

        def rate(t: float, s: np.ndarray) -> Any:
            return (self._incident(t) - s) / relaxation

        def yields(t: float, s: np.ndarray) -> float:
            limit = np.squeeze(self._strength(t, path))
            return float(abs(s[0]) - limit - BEYOND * self.peak)

        found = self._solved(rate, start, stop, stress, self.peak, {yields: 1})
        return Phase(start, found.t[-1], 0, path, slide, found.sol)

    def _slide(self, start: float, stop: float, way: int, path: float, slide: float) -> Phase:
        joint, weakens = self.joint, self._weakens(path)
        if joint.lost and path == 0:
            share = float(np.squeeze(self._share(self.pressed(start)[0], weakens)))
            path = joint.lost * joint.compliance / share or TINY
            slide += way * path

        def rate(t: float, s: np.ndarray) -> Any:
            return np.squeeze(self._rate(t, way, s[0], weakens))

        def is_weak(t: float, s: np.ndarray) -> float:
            return float(s[0]) - joint.distance

        scale = min(joint.distance, self.peak / self.impedance * SPANS * self.span)
        ends = {rate: -1} | ({is_weak: 1} if weakens else {})
        found = self._solved(rate, start, stop, path, scale, ends)
        return Phase(start, found.t[-1], way, path, slide, found.sol)

    def _solved(
        self, rate: Any, start: float, stop: float, now: float, scale: float, ends: dict[Any, int]
    ) -> Any:
        """Return the solution from `now` until one of `ends` falls (-1) or rises (1) through 0."""
        from scipy.integrate import solve_ivp

        for event, direction in ends.items():
            event.terminal, event.direction = True, direction
        with np.errstate(over="ignore", invalid="ignore"):  # in trial steps that are too long
            return solve_ivp(
                rate, (start, stop), np.array([now]), "DOP853", events=[*ends], dense_output=True,
                max_step=self.span, rtol=self.tolerance, atol=self.tolerance * scale,
            )  # fmt: skip
