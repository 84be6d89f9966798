"""Fit keys of a scene to measured waveforms by nonlinear least squares.

lmfit searches and gives the Jacobian at the best fit, from which standard errors and correlations
follow; the 95 % interval is that of Student's t. Positive keys are searched on a logarithmic scale.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import t as student

from jointwave.cases.errors import SceneError, StoppedError, require
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress, applies
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.external import READ_CURVES, Curves
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies.fit_keys import CLOCK, FreeKey, changed, free_keys
from jointwave.compare.studies.fit_trials import started, trials_of
from jointwave.compare.studies.forecast import Run

STEPS = 6  # of a search that converges, usually
SHORT = 200  # blocks, up to which matrix exponentials are cheap
POOR = 0.2  # misfit above which another start may fit better
NEAR = 1e-6  # of an unknown to its bound
ALIKE = 0.99  # correlation above which two keys are indistinguishable
LOST = 3e4  # times the error of a key fitted alone: derivatives by differences tell no more


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    scene : with the fitted keys, else as given. solver : the engine or exact solution.
    values : a row per key: its value, its standard error, `low` and `high`, its 95 % interval
    (infinite if the waveforms do not bound it), its `start`, all SI, and whether it is `at_bound`.
    correlation : of the keys. waveforms : a row per measured waveform: its file's `name`, its
    `place`, and the relative L2 misfit of the motion `before` and `after`. trials : number of
    solutions of the scene. notes : warnings, one sentence each.
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

    curves : from `read_curves`. free : dotted keys, KEY, KEY=START or
    KEY=LOW:START:HIGH, and `clock`, a shift added to the times of all files, s. solver : an engine
    or exact solution; None: the exact chain of rigid blocks if it applies and is short, else
    `dem`. Each waveform has the same weight, relative to its size; amplitudes are not scaled.
    Intervals are of 95 %, linearised at the best fit, and valid if the model is correct and
    residuals independent.

    Raises SceneError for keys and curves that cannot be fitted, StoppedError if the search does not
    converge.
    """
    scene = load(scene)
    if not curves or not free:
        raise SceneError(scene.where, "", None, "a fit needs a curve of this scene and a free key")
    for one in curves:
        require(one, Curves, "fit", "curves", READ_CURVES)
    keys = free_keys([free] if isinstance(free, str) else list(free), scene)
    first = changed(scene, {k.key: k.start for k in keys if k.key != CLOCK})
    name = _solver_of(first, solver)
    keys = [started(key, first, name, curves[0]) if key.key == CLOCK else key for key in keys]
    trials = trials_of(first, name, curves, keys, progress)
    before = list(map(np.linalg.norm, trials.residuals(key.unknown(key.start) for key in keys)))
    best = trials.search()
    if best is None:
        raise StoppedError(
            f"fit: not converged after {trials.count} solutions: start closer "
            "(--free KEY=START), bound the keys, or free fewer"
        )
    after = list(map(np.linalg.norm, trials.residuals(best.x.tolist())))
    waveforms = pd.DataFrame(trials.measured)[["name", "place"]].assign(before=before, after=after)
    values, correlation = _estimates(keys, best)
    fitted = changed(scene, {k: v for k, v in values.value.items() if k != CLOCK})
    notes = _notes(values, correlation, float(max(after)))
    return Fit(fitted, name, values, correlation, waveforms, trials.count, notes)


def planned(scene: AnyScene, free: Sequence[str], solver: str | None = None) -> Run:
    """Return the runs of a fit: usually some `STEPS` of its search, with derivatives of each key
    from both sides."""
    keys = free_keys(list(free), scene)
    first = changed(scene, {k.key: k.start for k in keys if k.key != CLOCK})
    count = 2 + STEPS * (2 * len(keys) + 1)
    return Run("", first, _solver_of(first, solver), count)


def _solver_of(scene: AnyScene, asked: str | None) -> str:
    """Return the solver of every trial; raises SceneError if it does not apply."""
    short = scene.is_column and scene.block_count <= SHORT and row_of_blocks.applies(scene)
    name = asked or (row_of_blocks.AXIAL.name if short else DEM.name)
    if not (answer := applies(name, scene)):
        raise SceneError(scene.where, "", None, f"{name} does not apply: {answer.reason}")
    return name


def _estimates(keys: list[FreeKey], best: Any) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the values of a fit and the correlations of its keys, from lmfit's result.

    The covariance of the unknowns is (J^T J)^-1 times the reduced chi-square; an error is infinite
    where waveforms do not change with an unknown, or with a combination that has it.
    """
    names = pd.Index([key.key for key in keys], name="key")
    size = np.linalg.norm(best.jac, axis=0)
    jac = best.jac / np.where(size > 0, size, 1.0)
    squares, vectors = np.linalg.eigh(jac.T @ jac)
    covariance = (vectors / np.maximum(squares, 1e-16)) @ vectors.T
    deviation = np.sqrt(np.diag(covariance))
    known = deviation < LOST
    errors = np.where(known, deviation / np.where(size > 0, size, 1.0) * np.sqrt(best.redchi), inf)
    half = errors * student.ppf(0.975, max(best.nfree, 1))
    rows = [_row(*one) for one in zip(keys, best.x.tolist(), errors, half, strict=True)]
    correlation = covariance / np.outer(deviation, deviation)
    return pd.DataFrame(rows, names), pd.DataFrame(correlation, names, names)


def _row(key: FreeKey, x: float, error: float, half: float) -> dict[str, Any]:
    """Return the value of a key, its error and its interval from those of its unknown."""
    value = key.value(x)
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
        "at_bound": min(x - key.unknown(key.low), key.unknown(key.high) - x) <= NEAR,
    }


def _notes(values: pd.DataFrame, correlation: pd.DataFrame, misfit: float) -> list[str]:
    """Return warnings about the values, in sentences."""
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
