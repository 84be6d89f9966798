"""Fit keys of a scene to measured waveforms by nonlinear least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cases.errors import SceneError, StoppedError
from cases.schema.scene import Scene
from compare.engines import Progress
from compare.experiments.fit.keys import CLOCK, Free, changed, free_keys
from compare.experiments.fit.problem import (
    Measured,
    Problem,
    clock_reach,
    problem_of,
    solver_of,
    started_clock,
)
from compare.experiments.fit.statistics import deviations, known, not_told_apart
from compare.misfit.external import Curves

MOST = 60  # steps of a search, each with its derivatives
TOLERANCE = 1e-12  # of the squares, the unknowns and the gradient
POOR = 0.2  # a misfit that asks for other starts
FACTORS = 10.0 ** np.arange(-2.0, 2.1, 0.5)  # of a start, for those
OTHERS = 2  # of them, the best
NEAR = 1e-6  # of an unknown to its bound
ROUND_OFF = 1e-6  # of a waveform: what is left then is no noise
LEAST_WEIGHT = 0.01  # of the largest relative noise: no waveform is trusted beyond


class Estimate(NamedTuple):
    """A fitted key: its value, its 95 % interval, infinite where the waveforms do not bound it,
    and where the search began; unit "" of a ratio; at_bound : whether a bound stopped it."""

    key: str
    value: float
    low: float
    high: float
    start: float
    unit: str
    at_bound: bool


class Fitted(NamedTuple):
    """One measured waveform [n] and the fitted one at the same times, s on the scene's clock, SI.

    before, after : relative L2 misfit of the motion at the start and at the end. independent : how
    many samples the residual's autocorrelation leaves.
    """

    name: str
    place: object
    time: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    before: float
    after: float
    independent: float


@dataclass(frozen=True)
class Fit:
    """What a fit has found.

    scene : with the fitted keys, else as it was given. solver : the engine or exact solution.
    estimates : a key each. correlation : [p, p] of the keys. waveforms : as measured and as fitted.
    trials : how often the scene was solved. notes : what a reader must know, a sentence each.
    """

    scene: Scene
    solver: str
    estimates: list[Estimate]
    correlation: np.ndarray
    waveforms: list[Fitted]
    trials: int
    notes: list[str]

    @property
    def before(self) -> float:
        """Misfit of the waveform that was furthest off at the start."""
        return max(one.before for one in self.waveforms)

    @property
    def after(self) -> float:
        """Misfit of the waveform that is furthest off at the end."""
        return max(one.after for one in self.waveforms)


def fit(
    scene: Scene,
    curves: Sequence[Curves],
    free: Sequence[str],
    solver: str | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fit keys of a scene to measured waveforms by least squares, and say how well they are known.

    curves : as `read_curves` returns them. free : dotted keys, KEY, KEY=START, KEY=LOW:HIGH or
    KEY=LOW:START:HIGH, and `clock`, what is added to the times of all files, s. solver : an engine
    or exact solution; None: the exact chain of rigid blocks where it holds and is short, else
    `dem`. Positive keys are sought on a logarithmic scale. Each waveform counts by its own noise;
    amplitudes are not scaled. Intervals are of 95 %, linear near the best fit, and hold if the
    model is right.

    Raises SceneError for keys and curves that cannot be fitted, StoppedError where the search ends
    without having converged.
    """
    keys = free_keys(list(free), scene)
    first = changed(scene, _scene_values(keys, [k.start or 0.0 for k in keys]))
    name = solver_of(first, solver)
    mine = [curve for curve in curves if curve.holds_for(scene)]
    if not mine or not keys:
        raise SceneError(scene.where, "", None, "a fit takes a curve of this scene and a free key")
    _refuse_several(mine)
    keys, clock = _with_clock(keys, first, name, mine)
    reach = clock_reach(scene) if clock is not None else 0.0
    problem = problem_of(first, name, mine, clock, reach)
    search = _Search(problem, keys, progress)
    unknowns = search.best()
    return _finished(scene, search, unknowns)


def _refuse_several(curves: list[Curves]) -> None:
    """Raise SceneError where two curves of one file are of one place, as of two solutions."""
    for i, one in enumerate(curves):
        for other in curves[:i]:
            if one.file == other.file and one.waveforms.keys() & other.waveforms.keys():
                several = ", ".join(c.name for c in curves if c.file == one.file)
                raise SceneError(one.file, "", None, f"holds {several}: fit to one of them")


def _scene_values(keys: Sequence[Free], values: Sequence[float]) -> dict[str, float]:
    return {k.key: v for k, v in zip(keys, values, strict=True) if k.key != CLOCK}


def _with_clock(
    keys: list[Free], scene: Scene, solver: str, curves: list[Curves]
) -> tuple[list[Free], float | None]:
    """Return the keys with the clock's start, by correlation unless given, and that start."""
    clock = next((key for key in keys if key.key == CLOCK), None)
    if clock is None:
        return keys, None
    start = clock.start
    if start is None:
        start = started_clock(scene, solver, curves)
    reach = clock_reach(scene)
    low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    if not low <= start <= high:
        start = (low + high) / 2 if low < high else (clock.low + clock.high) / 2
        low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    moved = _Clock(CLOCK, start, low, high, False, "s")
    return [moved if key.key == CLOCK else key for key in keys], start


class _Clock(Free):
    """The clock, whose unknown is in units of its reach wherever it begins."""

    @property
    def size(self) -> float:
        """Half of what it may move by."""
        return (self.high - self.low) / 2


class _Search:
    """A least-squares search in the unknowns of some keys, with weights by waveform."""

    def __init__(self, problem: Problem, keys: list[Free], progress: Progress | None) -> None:
        self.problem, self.keys, self.progress = problem, keys, progress
        self.trials = self.refused = 0
        self.weights = [1 / m.size / np.sqrt(len(m.time)) for m in problem.measured]
        self.low = np.array([-np.inf if k.low == -np.inf else k.unknown(k.low) for k in keys])
        self.high = np.array([np.inf if k.high == np.inf else k.unknown(k.high) for k in keys])
        self.start = np.zeros(len(keys))
        begun = self.residuals(self.start)
        assert begun is not None  # it was solved before
        self.begun = begun

    def values(self, x: np.ndarray) -> list[float]:
        """Return the keys' values for unknowns [p]."""
        return [key.value(u) for key, u in zip(self.keys, x, strict=True)]

    def residuals(self, x: np.ndarray) -> list[np.ndarray] | None:
        """Return solution less measured of each waveform [n], SI; None where nothing solves it."""
        self.trials += 1
        found = self.problem.residual(
            {k.key: v for k, v in zip(self.keys, self.values(x), strict=True)}
        )
        self.refused += found is None
        if self.progress:
            self.progress(1 - 0.97**self.trials)  # nobody knows how many there will be
        return found

    def jacobians(self, x: np.ndarray) -> list[np.ndarray]:
        """Return the derivatives of each waveform [n, p]: central, or to the side that is there."""
        columns = [self._derivative(x, i) for i in range(len(x))]
        return [np.stack(parts, axis=1) for parts in zip(*columns, strict=True)]

    def _derivative(self, x: np.ndarray, i: int) -> list[np.ndarray]:
        ends: list[tuple[float, list[np.ndarray] | None]] = []
        for sign in (-1, 1):
            there = x.copy()
            there[i] = np.clip(x[i] + sign * self.problem.step, self.low[i], self.high[i])
            found = self.residuals(there) if there[i] != x[i] else None
            ends.append((x[i], None) if found is None else (there[i], found))
        if ends[0][1] is None or ends[1][1] is None:
            here = self.residuals(x)
            ends = [(u, here if r is None else r) for u, r in ends]
        (a, low), (b, high) = ends
        if low is None or high is None or a == b:
            raise StoppedError("fit: no solution near the values that were reached")
        return [(after - before) / (b - a) for before, after in zip(low, high, strict=True)]

    def _weighed(self, parts: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([w * part for w, part in zip(self.weights, parts, strict=True)])

    def run(self, start: np.ndarray) -> tuple[np.ndarray, float, bool]:
        """Return the unknowns of least squares from a start, their squares, and whether the search
        has converged."""
        from scipy.optimize import least_squares

        def squares(x: np.ndarray) -> np.ndarray:
            found = self.residuals(x)
            missing = sum(len(m.time) for m in self.problem.measured)
            return np.full(missing, np.inf) if found is None else self._weighed(found)

        found = least_squares(
            squares,
            start,
            jac=lambda x: self._weighed(self.jacobians(x)),
            bounds=(self.low, self.high),
            method="trf",
            x_scale="jac",
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=MOST,
        )
        return found.x, float(found.cost), found.status > 0

    def best(self) -> np.ndarray:
        """Return the unknowns that fit best, from other starts too where the fit is poor; raises
        StoppedError where no search has converged."""
        found = [self.run(self.start)]
        if self._misfit(found[0][0]) > POOR:
            found += [self.run(start) for start in self._other_starts()]
        converged = [one for one in found if one[2]]
        if not converged:
            values = self.values(min(found, key=lambda one: one[1])[0])
            at = ", ".join(f"{k.key} = {v:.6g}" for k, v in zip(self.keys, values, strict=True))
            raise StoppedError(
                f"fit: not converged after {self.trials} solutions, at {at}: begin closer "
                "(--free KEY=START), bound the keys, or free fewer"
            )
        best = min(converged, key=lambda one: one[1])[0]
        if len(self.weights) == 1:
            return best
        self._weigh_by_noise(best)
        again, _, done = self.run(best)
        return again if done else best

    def _weigh_by_noise(self, x: np.ndarray) -> None:
        """Let each waveform count by its residual, as the noise of its own gauge."""
        found = self.residuals(x)
        assert found is not None
        sizes = [m.size for m in self.problem.measured]
        noise = [d / s for d, s in zip(deviations(found, len(x)), sizes, strict=True)]
        least = LEAST_WEIGHT * max(noise)
        if least > 0:
            relative = [max(n, least) / max(noise) for n in noise]
            self.weights = [w / r for w, r in zip(self.weights, relative, strict=True)]

    def _misfit(self, x: np.ndarray) -> float:
        found = self.residuals(x)
        return np.inf if found is None else max(misfits(found, self.problem.measured))

    def _other_starts(self) -> list[np.ndarray]:
        """Return the starts that fit best of those with one key a factor larger or smaller."""
        starts: list[tuple[float, int, np.ndarray]] = []
        for i, key in enumerate(self.keys):
            for factor in FACTORS if key.logarithmic else ():
                x = self.start.copy()
                x[i] = np.clip(np.log(factor), self.low[i], self.high[i])
                starts.append((self._misfit(x), len(starts), x))
        return [x for misfit, _, x in sorted(starts)[:OTHERS] if np.isfinite(misfit)]


def misfits(residuals: list[np.ndarray], measured: list[Measured]) -> list[float]:
    """Return the relative L2 misfit of each waveform, of the measured motion."""
    return [
        float(np.sqrt(np.mean(r**2))) / m.size for r, m in zip(residuals, measured, strict=True)
    ]


def _finished(scene: Scene, search: _Search, x: np.ndarray) -> Fit:
    residuals = search.residuals(x)
    assert residuals is not None
    measured, keys = search.problem.measured, search.keys
    about = known(residuals, search.jacobians(x))
    values = search.values(x)
    bounds = zip(x, search.low, search.high, strict=True)
    stopped = [bool(min(u - a, b - u) <= NEAR) for u, a, b in bounds]
    estimates = [
        Estimate(key.key, value, *_interval(key, u, r), key.start or 0.0, key.unit, at_bound)
        for key, value, u, r, at_bound in zip(keys, values, x, about.reach, stopped, strict=True)
    ]
    clock = next((e.value for e in estimates if e.key == CLOCK), 0.0)
    before, after = misfits(search.begun, measured), misfits(residuals, measured)
    waveforms = [
        Fitted(m.name, m.place, m.time + clock, m.values, m.values + r, b, a, n)
        for m, r, b, a, n in zip(measured, residuals, before, after, about.independent, strict=True)
    ]
    fitted = changed(scene, _scene_values(keys, values))
    notes = _notes(estimates, about.correlation, waveforms, search)
    solver = search.problem.solver
    return Fit(fitted, solver, estimates, about.correlation, waveforms, search.trials, notes)


def _interval(key: Free, unknown: float, reach: float) -> tuple[float, float]:
    """Return the ends of an interval of the value, beyond any bound of the key."""
    if not np.isfinite(reach):
        return (0.0, np.inf) if key.logarithmic else (-np.inf, np.inf)
    if key.logarithmic:
        start = key.start or 0.0
        return start * float(np.exp(unknown - reach)), start * float(np.exp(unknown + reach))
    middle = (key.start or 0.0) + key.size * unknown
    return middle - key.size * float(reach), middle + key.size * float(reach)


def _notes(
    estimates: list[Estimate], correlation: np.ndarray, waveforms: list[Fitted], search: _Search
) -> list[str]:
    """Return what a reader of the values must know."""
    found = [
        f"{e.key} stopped at its bound, {e.value:.6g}: its interval does not hold"
        for e in estimates
        if e.at_bound
    ]
    found += [
        f"{e.key} is not determined by these waveforms: they do not depend on it, or only on it "
        "together with another key"
        for e in estimates
        if not np.isfinite(e.high)
    ]
    found += not_told_apart(correlation, [e.key for e in estimates])
    for one in waveforms:
        widened = (len(one.time) / one.independent) ** 0.5
        if widened > 1.05 and one.after > ROUND_OFF:
            found.append(
                f"{one.name}, {one.place}: {len(one.time)} samples count as "
                f"{one.independent:.0f} independent ones, because what is left of one is like its "
                f"neighbour's: intervals are {widened:.2g} times as wide"
            )
    if search.refused:
        found.append(
            f"{search.refused} of {search.trials} trials had no solution and were left out"
        )
    return found
