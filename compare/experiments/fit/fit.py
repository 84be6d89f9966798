"""Fit keys of a scene to measured waveforms by nonlinear least squares."""

from collections.abc import Sequence

import numpy as np

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import Progress
from compare.experiments.fit.keys import CLOCK, Free, changed, free_keys
from compare.experiments.fit.problem import clock_reach, problem_of, solver_of, started_clock
from compare.experiments.fit.result import Estimate, Fit, Fitted
from compare.experiments.fit.search import FitSearch, misfits
from compare.experiments.fit.statistics import known, not_told_apart
from compare.misfit.external import Curves

NEAR = 1e-6  # of an unknown to its bound
ROUND_OFF = 1e-6  # of a waveform: smaller residuals are not noise


def fit(
    scene: AnyScene,
    curves: Sequence[Curves],
    free: Sequence[str],
    solver: str | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fit keys of a scene to measured waveforms by least squares, with confidence intervals.

    curves : from `read_curves`. free : dotted keys, KEY, KEY=START, KEY=LOW:HIGH or
    KEY=LOW:START:HIGH, and `clock`, a shift added to the times of all files, s. solver : an engine
    or exact solution; None: the exact chain of rigid blocks if it applies and is short, else
    `dem`. Positive keys are searched on a logarithmic scale. Each waveform is weighted by its own
    noise; amplitudes are not scaled. Intervals are of 95 %, linearised at the best fit, and valid
    if the model is correct.

    Raises SceneError for keys and curves that cannot be fitted, StoppedError if the search does not
    converge.
    """
    keys = free_keys(list(free), scene)
    first = changed(scene, _scene_values(keys, [k.start for k in keys]))
    name = solver_of(first, solver)
    mine = [curve for curve in curves if curve.holds_for(scene)]
    if not mine or not keys:
        raise SceneError(scene.where, "", None, "a fit needs a curve of this scene and a free key")
    _refuse_several(mine)
    keys, clock = _with_clock(keys, first, name, mine)
    reach = clock_reach(scene) if clock is not None else 0.0
    problem = problem_of(first, name, mine, clock, reach)
    search = FitSearch(problem, keys, progress)
    unknowns = search.best()
    return _finished(scene, search, unknowns)


def _refuse_several(curves: list[Curves]) -> None:
    """Raise SceneError if two curves of one file are at the same place, as of two solutions."""
    for i, one in enumerate(curves):
        for other in curves[:i]:
            if one.file == other.file and one.waveforms.keys() & other.waveforms.keys():
                several = ", ".join(c.name for c in curves if c.file == one.file)
                raise SceneError(one.file, "", None, f"holds {several}: fit to one of them")


def _scene_values(keys: Sequence[Free], values: Sequence[float]) -> dict[str, float]:
    return {k.key: v for k, v in zip(keys, values, strict=True) if k.key != CLOCK}


def _with_clock(
    keys: list[Free], scene: AnyScene, solver: str, curves: list[Curves]
) -> tuple[list[Free], float | None]:
    """Return the keys with the clock's start, by correlation unless given, and that start."""
    clock = next((key for key in keys if key.key == CLOCK), None)
    if clock is None:
        return keys, None
    start = started_clock(scene, solver, curves) if np.isnan(clock.start) else clock.start
    reach = clock_reach(scene)
    low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    if not low <= start <= high:
        start = (low + high) / 2 if low < high else (clock.low + clock.high) / 2
        low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    # Its unknown is in units of its reach, for any start.
    moved = clock._replace(start=start, low=low, high=high, size=(high - low) / 2)
    return [moved if key is clock else key for key in keys], start


def _finished(scene: AnyScene, search: FitSearch, x: np.ndarray) -> Fit:
    residuals = search.residuals(x)
    assert residuals is not None
    measured, keys = search.problem.measured, search.keys
    about = known(residuals, search.jacobians(x))
    values = search.values(x)
    bounds = zip(x, search.low, search.high, strict=True)
    stopped = [bool(min(u - a, b - u) <= NEAR) for u, a, b in bounds]
    estimates = [
        Estimate(key.key, value, *_interval(key, u, r), key.start, key.unit, at_bound)
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
        low, high = (key.start * float(np.exp(unknown + r)) for r in (-reach, reach))
        return low, high
    middle = key.start + key.size * unknown
    return middle - key.size * float(reach), middle + key.size * float(reach)


def _notes(
    estimates: list[Estimate], correlation: np.ndarray, waveforms: list[Fitted], search: FitSearch
) -> list[str]:
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
    found += not_told_apart(correlation, [e.key for e in estimates])
    for one in waveforms:
        widened = (len(one.time) / one.independent) ** 0.5
        if widened > 1.05 and one.after > ROUND_OFF:
            found.append(
                f"{one.name}, {one.place}: {len(one.time)} samples count as "
                f"{one.independent:.0f} independent ones, because residuals of neighbours are "
                f"correlated: intervals are {widened:.2g} times as wide"
            )
    if search.refused:
        found.append(f"{search.refused} of {search.trials} trials had no solution and were skipped")
    return found
