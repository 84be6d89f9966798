"""Motion of blocks by Taylor series; chains with no-tension joints from event to event.

While no joint opens or closes the blocks are linear, and their motion from rest under static
gravity and prestress is a Taylor series of x' = A x + b f(t): with steps of STEP over the norm of A
the term of order ORDER is below round-off (Hairer, Norsett & Wanner, Solving Ordinary Differential
Equations I, 1993, I.8). The forces of a joint and of its spring are then polynomials; they keep one
sign if all their Bernstein coefficients have it, otherwise their roots are computed. At the first
change of sign the step ends, the joint opens or closes, and the series restarts.

A no-tension joint is closed while neither its spring nor spring and dashpot together are in
tension. A damped joint opens when their sum vanishes, with its spring still compressed, and closes
when the gap vanishes, at once with the force of its dashpot.
"""

from collections.abc import Callable
from itertools import pairwise
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.polynomial import polyder, polyval
from scipy.sparse import csr_array

from jointwave.cases.histories import LoadHistory
from jointwave.cases.size import require
from jointwave.compare.exact.blocks.system import BlockSystem

ORDER = 24
STEP = 2.0  # over the norm of A: the last term is 2^24 / 24! = 3e-17
LOAD_STEP = 1 / 24  # step over the load's period: its interpolation error is below 1e-15
SETTLED = 4 / 3  # end of a wavelet (1e-24) over the time at which it has fallen to 1e-8
LEAST = 1e-6  # least time, in steps, between changes of a joint that has just changed twice
NOISE = 1024.0  # perturbation of every step of the twin, in units of round-off
NEGLIGIBLE = 1e-18  # coefficients that are dropped, over the largest
NOW = 1e-14  # roots nearer to the step's start, in steps, are its own event or round-off
REAL = 1e-6  # largest imaginary part of a real root: round-off splits two close roots

_NODES = (1 + chebpts1(10)) / 2
_POWERS = np.vander(_NODES, increasing=True)
#: From power coefficients to Bernstein coefficients (Farouki 2012).
_BERNSTEIN = np.array(
    [[comb(i, k) / comb(ORDER, k) for k in range(ORDER + 1)] for i in range(ORDER + 1)]
)


class Loads(NamedTuple):
    """Several loads: values [n, loads] at times [n] (s), and times at which they are not smooth."""

    value: Callable[[np.ndarray], np.ndarray]
    breaks: np.ndarray


def integrate(
    system: BlockSystem,
    load: LoadHistory | Loads,
    times: np.ndarray,
    period: float | None = None,
    noise: float = 0.0,
    seed: int = 0,
) -> "Motion":
    """Return the motion of blocks under their load or loads.

    times : increasing, s; the blocks are at rest at the first.
    period : of the load (s), if it has one.
    noise : random perturbation of every step, relative to its terms, that mimics round-off; the
        motion has the floating-point type of `times`.
    """
    size = len(system.steady)
    require(3 * 8.0 * len(times) * size, f"{len(times):,} states of {size:,} numbers")
    motion = Motion(system, load, times, period, noise, seed)
    breaks = [t for t in load.breaks if times[0] < t < times[-1]]
    for start, end in pairwise([times[0], *breaks, times[-1]]):
        motion.to(start, end)
    return motion


class Motion:
    """The motion of blocks from rest, and of no-tension joints.

    states : float array [n, m], of the `BlockSystem`. events : number of openings and closings.
    steps : number of Taylor series. closed, changed : whether each joint is closed, and how often
    it has changed at the current time. zero : [2, joints], whether the force of the spring, or of
    spring and dashpot, is zero now.
    """

    def __init__(self, system, load, times, period, noise, seed) -> None:
        self.system, self.load, self.times, self.noise = system, load, times, noise
        self.random = np.random.default_rng(seed)
        self.x = np.zeros(len(system.steady), dtype=times.dtype)
        self.states = np.zeros((len(times), len(self.x)), dtype=times.dtype)
        self.known, self.events, self.steps = 1, 0, 0
        self.matrix = system.matrix
        norm = float(abs(self.matrix).sum(axis=1).max())
        self.longest = STEP / norm * (1.0 if noise == 0 else 0.77)
        self.pushes = csr_array(system.load.reshape(-1, len(self.x)))
        self.pulse = (0.0, 0.0)
        if period is not None:
            self.pulse = (period * LOAD_STEP, SETTLED * load.end)
        joints, count = system.one_sided, len(system.one_sided)
        self.at_rest, self.resists = system.initial[joints], system.resists[joints]
        self.closed, self.changed = self.at_rest >= 0, np.zeros(count, int)
        self.zero = np.zeros((2, count), dtype=bool)
        self._drop_open_joints()

    def _drop_open_joints(self) -> None:
        """Remove the forces of open joints from the equations of motion."""
        system, self.held = self.system, np.ones(len(self.system.initial))
        self.held[system.one_sided[~self.closed]] = 0.0
        self.steady = system.steady - system.moves @ ((1 - self.held) * system.initial)

    def to(self, start: float, end: float) -> None:
        """Advance from `start` to `end` (s), between which the load is smooth."""
        t = start
        while t < end:
            longest = self.longest
            if t < self.pulse[1]:
                longest = min(longest, self.pulse[0])
            remaining = end - t
            h = remaining / max(1, int(np.ceil(remaining / longest * (1 - 1e-9))))
            last = h == remaining
            share = self._step(t, h, end if last else t + h)
            t = end if last and share == 1 else t + h * share

    def _step(self, t: float, h: float, end: float) -> float:
        """Advance by one series, to its end or the first event; return the completed fraction."""
        X = self._series(t, h)
        first, event = self._first_event(X)
        until = end if event is None else t + h * first
        more = int(np.searchsorted(self.times, until, side="right"))
        if more > self.known:
            at = (self.times[self.known : more] - t) / h
            self.states[self.known : more] = np.vander(at, ORDER + 1, increasing=True) @ X
            self.known = more
        powers = first ** np.arange(ORDER + 1)
        self.x = powers @ X
        if self.noise:
            drawn = self.random.uniform(-1, 1, len(self.x))
            self.x += self.noise * np.finfo(float).eps * drawn * (powers @ np.abs(X))
        self.steps += 1
        self._change(first, event)
        return first

    def _series(self, t: float, h: float) -> np.ndarray:
        """Return the state's Taylor coefficients [ORDER + 1, m] over the fraction of a step."""
        values = self.load.value(t + h * _NODES).astype(float)
        drive = np.linalg.solve(_POWERS, values.reshape(len(_NODES), -1))
        rates = np.zeros((ORDER, len(self.x)), dtype=self.x.dtype)
        rates[: len(drive)] = drive @ self.pushes
        rates[0] += self.steady
        X = np.zeros((ORDER + 1, len(self.x)), dtype=self.x.dtype)
        X[0] = self.x
        for k, rate in enumerate(rates):
            X[k + 1] = h / (k + 1) * (self._rate(X[k]) + rate)
        return X

    def _rate(self, x: np.ndarray) -> np.ndarray:
        """Return A x; with no-tension joints from their strains, so that round-off does not strain
        blocks that move together."""
        if not len(self.closed):
            return self.matrix @ x
        forces = self.system.resists @ (self.system.strains @ x)
        return self.system.free @ x + self.system.moves @ (self.held * forces)

    def _first_event(self, X: np.ndarray) -> tuple[float, tuple[int, int] | None]:
        """Return the fraction of the step at the first change of a joint, the joint and force."""
        system, count = self.system, len(self.system.initial)
        if not len(system.one_sided):
            return 1.0, None
        strains = system.strains @ X.T
        springs = self.resists[:, :count] @ strains[:count]
        forces = np.array([springs.T, (self.resists @ strains).T])
        forces[:, 0] += self.at_rest
        forces[:, 0][self.zero] = 0.0
        best, event = 1.0, None
        for i in np.flatnonzero(~_stay(_BERNSTEIN @ forces, self.closed)):
            least = LEAST if self.changed[i] > 1 else 0.0
            own, now = forces[:, :, i], self.closed[i]
            bounds = own * best ** np.arange(ORDER + 1) @ _BERNSTEIN.T
            if _stay(bounds, now):  # until the first event so far
                continue
            crosses = (bounds.min(axis=1) < 0) & (bounds.max(axis=1) > 0)
            found = _first_change(own, crosses, now, least, best)
            if found is not None and (found[0] < best or event is None):
                best, event = found[0], (int(i), found[1])
        return best, event

    def _change(self, share: float, event: tuple[int, int] | None) -> None:
        """Open or close the joint of an event; if time has advanced, clear old changes."""
        if share > 0:
            self.changed[:] = 0
            self.zero[:] = False
        if event is not None:
            i, kind = event
            self.closed[i] = not self.closed[i]
            self.changed[i] += 1
            self.zero[kind, i] = True
            self.events += 1
            self._drop_open_joints()


def _stay(bounds: np.ndarray, closed: np.ndarray) -> np.ndarray:
    """Return whether joints stay closed or open, from the Bernstein coefficients of the forces of
    their spring, and of spring and dashpot [2, ORDER + 1, ...]."""
    return np.where(closed, (bounds >= 0).all(axis=(0, 1)), (bounds <= 0).all(axis=1).any(axis=0))


def _first_change(
    forces: np.ndarray, crosses: np.ndarray, closed: bool, least: float, up_to: float
) -> tuple[float, int] | None:
    """Return the first time before `up_to` at which a joint changes, and the force that causes it
    (0 spring, 1 spring and dashpot), or None. crosses : forces that may become zero."""
    found = [(r, int(kind)) for kind in np.flatnonzero(crosses) for r in _roots(forces[kind])]
    roots = [one for one in found if one[0] < up_to]
    edges = sorted([(0.0, -1), *roots])
    for (a, kind), b in zip(edges, [*(r for r, _ in edges[1:]), up_to], strict=True):
        values = polyval((a + b) / 2, forces.T)
        holds = values.min() >= 0
        if b > least and holds != closed:
            a = max(a, least)
            return a, kind if kind >= 0 else int(values[1] < values[0])
    return None


def _roots(powers: np.ndarray) -> list[float]:
    """Return the roots of a polynomial in (0, 1), to round-off by Newton steps."""
    kept = np.flatnonzero(np.abs(powers) > NEGLIGIBLE * np.abs(powers).max())[-1] + 1
    found = np.roots(powers[:kept][::-1].astype(float))
    x = found.real[(np.abs(found.imag) < REAL) & (found.real > 0) & (found.real < 1)]
    for _ in range(2):
        slope = polyval(x, polyder(powers))
        x = x - np.divide(polyval(x, powers), slope, out=np.zeros_like(slope), where=slope != 0)
    return x[(x > NOW) & (x < 1)].tolist()
