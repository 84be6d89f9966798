"""Fit keys of a scene to measured waveforms by nonlinear least squares.

lmfit searches and returns the Jacobian at the best fit, which gives standard errors and
correlations; 95 % intervals use Student's t. Positive keys are searched on a logarithmic scale.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isnan
from typing import Any

import numpy as np
import pandas as pd
from lmfit import Parameters, minimize
from scipy.interpolate import CubicSpline
from scipy.stats import t as student

from jointwave.cases.errors import SceneError, StoppedError, UnstableError, require
from jointwave.cases.sampling import resolved_period
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress, applies, solve
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.alignment import INSTANT, align_curve, static_level
from jointwave.compare.misfit.external import READ_CURVES, Curves
from jointwave.compare.misfit.metrics import rms
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies.fit_keys import CLOCK, ORIGIN, FreeKey, changed, free_keys
from jointwave.compare.studies.forecast import Run

STEPS = 6  # usual number of steps of a search that converges
SHORT = 200  # blocks up to which matrix exponentials are cheap
POOR = 0.2  # misfit above which another start may fit better
NEAR = 1e-6  # distance of an unknown from a bound that counts as at the bound
ALIKE = 0.99  # correlation above which two keys are indistinguishable
LOST = 3e4  # error of a key over its error if fitted alone, above which it is not determined
FINER = 4  # samples of the solution per sample of the scene, if the clock is free
EXACT_STEP, COMPUTED_STEP = 1e-4, 1e-3  # difference step of an unknown
LEAST_SAMPLES = 10  # of a waveform
TOLERANCE = 1e-12  # of the squares, the unknowns and the gradient
MOST = 60  # steps of a search, each with its derivatives


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    scene : the given one with the fitted keys. solver : the engine or exact solution. values : a
    row per key: its `value`, standard `error`, 95 % interval `low` to `high` (infinite if the
    waveforms do not bound it) and `start`, all SI, and whether it is `at_bound`. correlation : of
    the keys. waveforms : a row per measured waveform: `name` of the file, `place`, and relative L2
    misfit `before` and `after` the fit. trials : number of solutions of the scene. notes :
    warnings, one sentence each.
    """

    scene: AnyScene
    solver: str
    values: pd.DataFrame
    correlation: pd.DataFrame
    waveforms: pd.DataFrame
    trials: int
    notes: list[str]

    @property
    def settings(self) -> list[str]:
        """The fitted keys of the scene as arguments of `--set`."""
        return [f"{key}={value:.12g}" for key, value in self.values.value.items() if key != CLOCK]

    @property
    def table(self) -> pd.DataFrame:
        """The values, a row per key, with their intervals and correlations."""
        return self.values.join(self.correlation.add_prefix("correlation with "))


def fit(
    scene: AnySource,
    curves: Sequence[Curves],
    free: str | Sequence[str],
    solver: str | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fit keys of a scene to measured waveforms by least squares, with confidence intervals.

    curves : from `read_curves`. free : dotted keys, KEY, KEY=START or KEY=LOW:START:HIGH, and
    `clock`, a shift added to the times of all files, s. solver : an engine or exact solution; None:
    the exact chain of rigid blocks if it applies and is short, else `dem`. All waveforms weigh the
    same, each relative to its size; amplitudes are not scaled. The 95 % intervals are linearised at
    the best fit, and valid if the model is correct and residuals are independent, of one variance
    in each waveform.

    Raises SceneError for keys and curves that cannot be fitted, StoppedError without convergence.
    """
    scene = load(scene)
    if not curves or not free:
        raise SceneError(scene.where, "", None, "a fit needs a curve of this scene and a free key")
    for one in curves:
        require(one, Curves, "fit", "curves", READ_CURVES)
    keys, first, name = _start(scene, [free] if isinstance(free, str) else free, solver)
    trials = _Trials(first, name, curves, keys, progress)
    before = trials.residuals(key.unknown(key.start) for key in trials.keys)
    best = trials.search()
    if best is None:
        raise StoppedError(
            f"fit: not converged after {trials.count} solutions: start closer "
            "(--free KEY=START), bound the keys, or free fewer"
        )
    waveforms = pd.DataFrame({"name": trials.names, "place": trials.places})
    for when, residuals in {"before": before, "after": trials.residuals(best.x)}.items():
        waveforms[when] = [np.linalg.norm(one) for one in residuals]
    values, correlation = _estimates(trials.keys, best, trials.lengths)
    fitted = changed(scene, {k: v for k, v in values.value.items() if k != CLOCK})
    notes = _notes(values, correlation, waveforms.after.max())
    return Fit(fitted, name, values, correlation, waveforms, trials.count, notes)


def planned(scene: AnyScene, free: Sequence[str], solver: str | None = None) -> Run:
    """Return the expected runs of a fit: `STEPS` steps, each with central differences per key."""
    keys, first, name = _start(scene, free, solver)
    return Run("", first, name, 2 + STEPS * (2 * len(keys) + 1))


def _start(
    scene: AnyScene, free: Sequence[str], solver: str | None
) -> tuple[list[FreeKey], AnyScene, str]:
    """Return the keys, the scene with their starting values, and the name of the solver; raises
    SceneError if the solver does not apply."""
    keys = free_keys(list(free), scene)
    first: Any = changed(scene, {k.key: k.start for k in keys if k.key != CLOCK})
    short = applies(row_of_blocks.AXIAL.name, first) and first.block_count <= SHORT
    name = solver or (row_of_blocks.AXIAL.name if short else DEM.name)
    if not (answer := applies(name, first)):
        raise SceneError(first.where, "", None, f"{name} does not apply: {answer.reason}")
    return keys, first, name


class _Trials:
    """Solutions of a scene for values of its free keys, compared with the measured waveforms.

    scene : with the sampling and duration that the fit needs. names, places : of the waveforms.
    count : of the solutions tried. Raises SceneError if a curve has too few samples within the
    scene's duration, or no waveform at its receivers.
    """

    def __init__(
        self,
        scene: AnyScene,
        solver: str,
        curves: Sequence[Curves],
        keys: list[FreeKey],
        progress: Progress | None,
    ) -> None:
        self.solver, self.progress, self.count = solver, progress, 0
        self.keys = [_clock(x, scene, solver, curves[0]) if x.key == CLOCK else x for x in keys]
        shift = next((key.start for key in self.keys if key.key == CLOCK), None)
        interval = scene.interval / (FINER if shift is not None else 1)
        record = {"interval": interval, "energy": False, "fields": None}
        end = scene.time.duration
        longer = {"duration": end + (0.0 if shift is None else resolved_period(scene))}
        tables: dict[str, Any] = {"record": scene.record.model_copy(update=record), "expect": {}}
        tables["time"] = scene.time.model_copy(update=longer)
        self.scene = scene.model_copy(update=tables)
        result = solve(solver, self.scene)
        found = []
        for one in curves:
            own = one.time + (shift or 0.0)
            inside = (own >= -INSTANT) & (own <= end + 1e-6 * scene.interval)
            for place, values in one.waveforms.items():
                if place.waveform(result) is None:
                    continue
                if inside.sum() < LEAST_SAMPLES:
                    allowed = (
                        f"must share at least {LEAST_SAMPLES} samples with the scene, 0 to "
                        f"{end:g} s, not {inside.sum()}; --free clock shifts its time"
                    )
                    raise SceneError(one.name, str(place), None, allowed)
                size = rms(values[inside] - static_level(place, result)) or 1.0
                found.append((one.name, place, one.time[inside], values[inside], size))
        if not found:
            raise SceneError(curves[0].file, "", None, "has no waveform at a receiver of the scene")
        self.names, self.places, self._times, self._values, self._sizes = zip(*found, strict=True)

    @property
    def lengths(self) -> list[int]:
        """Number of samples of each waveform."""
        return [len(at) for at in self._times]

    def search(self) -> Any:
        """Return lmfit's result; None if the search does not converge."""
        given = Parameters()
        for i, key in enumerate(self.keys):
            low, start, high = map(key.unknown, (key.low, key.start, key.high))
            given.add(f"key_{i}", start, min=low, max=high)
        step = COMPUTED_STEP if self.solver in ENGINES else EXACT_STEP
        options: dict[str, Any] = {"jac": "3-point", "diff_step": step / ORIGIN, "x_scale": "jac"}
        options |= dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE)
        options |= {"nan_policy": "propagate", "max_nfev": MOST * (2 * len(self.keys) + 1)}
        try:
            with np.errstate(invalid="ignore"):  # of lmfit's covariance, in place of `_estimates`
                found = minimize(self._all_residuals, given, method="least_squares", **options)
        except ValueError:  # no derivative: a neighbour has no solution
            return None
        return found if found.success else None

    def _all_residuals(self, unknowns: Parameters) -> np.ndarray:
        """Return all residuals; infinite without a solution, so that the step gets shorter."""
        try:
            return np.concatenate(self.residuals(unknowns.valuesdict().values()))
        except (SceneError, UnstableError):
            return np.full(sum(self.lengths), inf)

    def residuals(self, x: Iterable[float]) -> list[np.ndarray]:
        """Return the residuals [n] of each waveform for the search variables [p]: solution minus
        measurement, scaled so that their norm is the relative L2 misfit. Raises SceneError or
        UnstableError if there is no solution."""
        self.count += 1
        if self.progress:
            self.progress(1 - 0.97**self.count)  # the number of trials is unknown
        values = {key.key: key.value(float(u)) for key, u in zip(self.keys, x, strict=True)}
        shift = values.pop(CLOCK, 0.0)
        result = solve(self.solver, changed(self.scene, values))
        time, found = result.time.values, []
        for place, at, measured, size in zip(
            self.places, self._times, self._values, self._sizes, strict=True
        ):
            at = np.clip(at + shift, time[0], time[-1])  # at rest before its first sample
            off = CubicSpline(time, place.waveform(result))(at) - measured
            found.append(off / (size * np.sqrt(len(off))))
        return found


def _clock(clock: FreeKey, scene: AnyScene, solver: str, curve: Curves) -> FreeKey:
    """Return the clock with its start (if not given, the shift that best correlates a file with the
    solution) and bounds at most one period of the load away."""
    start, reach = clock.start, resolved_period(scene)
    if isnan(start):
        found = align_curve(curve, scene, {solver: solve(solver, scene)}, align=True).shift
        start = found.seconds if found else 0.0
    low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    return clock._replace(start=start, low=low, high=high)


def _estimates(
    keys: list[FreeKey], best: Any, lengths: list[int]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the values of a fit and the correlations of its keys, from lmfit's result.

    The covariance of the unknowns is A (sum_i s_i^2 J_i^T J_i) A, A = (J^T J)^-1, with the variance
    s_i^2 of the residuals of each waveform, whose number of samples is in `lengths`. The error of a
    key is infinite if waveforms do not depend on it or on a combination of keys that contains it.
    """
    names = pd.Index([key.key for key in keys], name="key")
    size = np.linalg.norm(best.jac, axis=0)
    jac = best.jac / np.where(size > 0, size, 1.0)
    squares, vectors = np.linalg.eigh(jac.T @ jac)
    covariance = (vectors / np.maximum(squares, 1e-16)) @ vectors.T
    deviation = np.sqrt(np.diag(covariance))
    waveform = np.repeat(np.arange(len(lengths)), lengths)
    variance = np.bincount(waveform, best.residual**2) / lengths * best.ndata / max(best.nfree, 1)
    spread = np.sqrt(variance)[waveform, None] * jac @ covariance
    known = deviation < LOST
    errors = np.linalg.norm(spread, axis=0) / np.where(size > 0, size, 1.0)
    errors = np.where(known, errors, inf)
    half = errors * student.ppf(0.975, max(best.nfree, 1))
    rows = [_row(*one) for one in zip(keys, best.x.tolist(), errors, half, strict=True)]
    correlation = covariance / np.outer(deviation, deviation)
    return pd.DataFrame(rows, names), pd.DataFrame(correlation, names, names)


def _row(key: FreeKey, x: float, error: float, half: float) -> dict[str, Any]:
    """Return the row of a key from its unknown `x`, the standard error and the half interval of x;
    both infinite if the half interval exceeds the distance between the bounds."""
    value = key.value(x)
    if half > key.unknown(key.high) - key.unknown(key.low):
        error = inf
    if np.isfinite(error):
        low, high = key.value(x - half), key.value(x + half)
    else:
        low, high = 0.0 if key.logarithmic else -inf, inf
    return {
        "value": value,
        "error": error * (value if key.logarithmic else key.size),
        "low": low,
        "high": high,
        "start": key.start,
        "at_bound": bool(error < inf)
        and min(x - key.unknown(key.low), key.unknown(key.high) - x) <= NEAR,
    }


def _notes(values: pd.DataFrame, correlation: pd.DataFrame, misfit: float) -> list[str]:
    """Return warnings about the fitted values, in sentences."""
    found = [
        f"{key} stopped at its bound, {value:.6g}: its interval is not valid"
        for key, value in values.value[values.at_bound].items()
    ]
    found += [
        f"{key} is not determined by these waveforms: they do not depend on it, or only in "
        "combination with another key"
        for key in values.index[np.isinf(values.high)]
    ]
    found += [
        f"{one} and {other} cannot be distinguished: correlation {correlation[one][other]:+.5f}"
        for i, one in enumerate(correlation)
        for other in correlation.columns[:i]
        if abs(correlation[one][other]) > ALIKE
    ]
    if misfit > POOR:
        found.append(f"a misfit of {misfit:.0%} is left: another start may fit better")
    return found
