"""Fit keys of a scene to measured waveforms by nonlinear least squares.

lmfit searches and gives standard errors and correlations from the Jacobian at the best fit; the
95 % interval is that of Student's t. Positive keys are searched on a logarithmic scale.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.stats import qmc
from scipy.stats import t as student

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place
from jointwave.compare.studies.fit_keys import CLOCK, FreeKey, changed, free_keys
from jointwave.compare.studies.fit_trials import Trials, solver_of, started, trials_of

POOR = 0.2  # misfit above which other starts are tried
STARTS, OTHERS = 12, 2  # other starts for each key, and the best of them that are searched from
DECADES = 2.0  # in which other starts lie, on either side
NEAR = 1e-6  # of an unknown to its bound
ALIKE = 0.99  # correlation above which two keys are indistinguishable
SINGULAR = 1e-9  # of the largest eigenvalue: accuracy of derivatives by differences


class Estimate(NamedTuple):
    """A fitted key: its value, its standard error, its 95 % interval (infinite if the waveforms do
    not bound it), and its starting value, SI; at_bound : whether it is at a bound of the key."""

    key: str
    value: float
    error: float
    low: float
    high: float
    start: float
    at_bound: bool


class Fitted(NamedTuple):
    """One measured waveform [n] and the fitted one at the same times, s on the scene's clock, SI;
    before, after : relative L2 misfit of the motion at the start and at the end."""

    name: str
    place: Place
    time: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    before: float
    after: float


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    scene : with the fitted keys, else as given. solver : the engine or exact solution.
    estimates : one per key. correlation : [p, p] of the keys. waveforms : both measured and fitted.
    trials : number of solutions of the scene. notes : warnings, one sentence each.
    """

    scene: AnyScene
    solver: str
    estimates: list[Estimate]
    correlation: np.ndarray
    waveforms: list[Fitted]
    trials: int
    notes: list[str]

    @property
    def settings(self) -> list[str]:
        """The fitted keys of the scene as arguments of `--set`."""
        return [f"{e.key}={e.value:.12g}" for e in self.estimates if e.key != CLOCK]

    @property
    def before(self) -> float:
        """Misfit of the worst waveform at the start."""
        return max(one.before for one in self.waveforms)

    @property
    def after(self) -> float:
        """Misfit of the worst waveform at the end."""
        return max(one.after for one in self.waveforms)


def fit(
    scene: AnyScene,
    curves: Sequence[Curves],
    free: Sequence[str],
    solver: str | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fit keys of a scene to measured waveforms by least squares, with confidence intervals.

    curves : from `read_curves`. free : dotted keys, KEY, KEY=START or
    KEY=LOW:START:HIGH, and `clock`, a shift added to the times of all files, s. solver : an engine
    or exact solution; None: the exact chain of rigid blocks if it applies and is short, else
    `dem`. Each waveform has the same weight, relative to its size; amplitudes are not scaled.
    Intervals are of 95 %, linearised at the best fit, and valid if the model is correct and
    residuals independent.

    Raises SceneError for keys and curves that cannot be fitted, StoppedError if the search does not
    converge.
    """
    keys = free_keys(list(free), scene)
    first = changed(scene, {k.key: k.start for k in keys if k.key != CLOCK})
    name = solver_of(first, solver)
    mine = list(curves)
    if not mine or not keys:
        raise SceneError(scene.where, "", None, "a fit needs a curve of this scene and a free key")
    keys = [started(key, first, name, mine) if key.key == CLOCK else key for key in keys]
    trials = trials_of(first, name, mine, keys, progress or (lambda fraction: None))
    start = np.array([key.unknown(key.start) for key in keys])
    begun = trials.residuals(start)
    assert begun is not None  # it was solved before
    return _finished(scene, trials, trials.misfits(begun), _best(trials, start))


def table(found: Fit) -> pd.DataFrame:
    """Return the values of a fit, a row per key, with their intervals and correlations."""
    correlations = pd.DataFrame(
        found.correlation, columns=[f"correlation with {e.key}" for e in found.estimates]
    )
    return pd.DataFrame(found.estimates).join(correlations)


def _best(trials: Trials, start: np.ndarray) -> Any:
    """Return lmfit's result of the best search, also from other starts if the first is poor.

    Raises StoppedError if no search has converged.
    """
    first = trials.search(start)
    found = [first]
    if first is None or trials.worst(first.x) > POOR:
        found += [trials.search(x) for x in _other_starts(trials, start)]
    converged = [one for one in found if one is not None]
    if not converged:
        raise StoppedError(
            f"fit: not converged after {trials.count} solutions: start closer "
            "(--free KEY=START), bound the keys, or free fewer"
        )
    return min(converged, key=lambda one: one.chisqr)


def _other_starts(trials: Trials, start: np.ndarray) -> list[np.ndarray]:
    """Return the best of some starts that fill the decades around the first (Latin hypercube)."""
    p = len(start)
    reach = DECADES * np.log(10)
    low = [max(k.unknown(k.low), x - reach) for k, x in zip(trials.keys, start, strict=True)]
    high = [min(k.unknown(k.high), x + reach) for k, x in zip(trials.keys, start, strict=True)]
    points = qmc.scale(qmc.LatinHypercube(p, seed=0).random(STARTS * p), low, high)
    ranked = sorted((trials.worst(x), i) for i, x in enumerate(points))
    return [points[i] for misfit, i in ranked[:OTHERS] if np.isfinite(misfit)]


def _finished(scene: AnyScene, trials: Trials, before: list[float], best: Any) -> Fit:
    keys, measured = trials.keys, trials.measured
    residuals = trials.residuals(best.x)
    assert residuals is not None
    errors, correlation = _uncertainty(best)
    quantile = float(student.ppf(0.975, max(best.nfree, 1)))
    estimates = [
        _estimate(*one, quantile) for one in zip(keys, best.x.tolist(), errors, strict=True)
    ]
    values = {e.key: e.value for e in estimates}
    clock = values.get(CLOCK, 0.0)
    waveforms = [
        Fitted(m.name, m.place, m.time + clock, m.values, m.values + r, b, a)
        for m, r, b, a in zip(measured, residuals, before, trials.misfits(residuals), strict=True)
    ]
    fitted = changed(scene, {k: v for k, v in values.items() if k != CLOCK})
    notes = _notes(estimates, correlation, trials)
    return Fit(fitted, trials.solver, estimates, correlation, waveforms, trials.count, notes)


def _uncertainty(best: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the standard errors of the unknowns [p] and their correlations [p, p].

    Their covariance is that of lmfit, (J^T J)^-1 times the reduced chi-square; an error is infinite
    where waveforms do not change with an unknown, or with a combination that has it.
    """
    size = np.linalg.norm(best.jac, axis=0)
    scale = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh((best.jac / scale).T @ (best.jac / scale))
    lost = (np.abs(vectors[:, values < SINGULAR * values[-1]]) > 0.01).any(axis=1) | (size == 0)
    covariance = (vectors / np.maximum(values, 1e-16)) @ vectors.T
    deviation = np.sqrt(np.diag(covariance))
    errors = np.where(lost, inf, deviation / scale * np.sqrt(best.redchi))
    return errors, covariance / np.outer(deviation, deviation)


def _estimate(key: FreeKey, x: float, error: float, quantile: float) -> Estimate:
    ends = key.unknown(key.low), key.unknown(key.high)
    at_bound = bool(min(x - ends[0], ends[1] - x) <= NEAR)
    value = key.value(x)
    if not np.isfinite(error):
        low = 0.0 if key.logarithmic else -inf
        return Estimate(key.key, value, inf, low, inf, key.start, at_bound)
    low, high = (key.value(x + s * quantile * error) for s in (-1, 1))
    own = error * (value if key.logarithmic else key.size)
    return Estimate(key.key, value, own, low, high, key.start, at_bound)


def _notes(estimates: list[Estimate], correlation: np.ndarray, trials: Trials) -> list[str]:
    """Return warnings about the values, in sentences."""
    found = [
        f"{e.key} stopped at its bound, {e.value:.6g}: its interval is not valid"
        for e in estimates
        if e.at_bound
    ]
    found += [
        f"{e.key} is not determined by these waveforms: they do not depend on it, or only "
        "in combination with another key"
        for e in estimates
        if not np.isfinite(e.high)
    ]
    found += [
        f"{one.key} and {other.key} cannot be distinguished: correlation {correlation[i, j]:+.5f}"
        for i, one in enumerate(estimates)
        for j, other in enumerate(estimates[:i])
        if abs(correlation[i, j]) > ALIKE
    ]
    if trials.refused:
        found.append(f"{trials.refused} of {trials.count} trials had no solution and were skipped")
    return found
