"""Solutions of a scene for values of its free keys, beside the measured waveforms of a fit."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isnan
from typing import Any, NamedTuple

import numpy as np
from lmfit import Parameters, minimize
from scipy.interpolate import CubicSpline

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, Progress, solve
from jointwave.compare.misfit.alignment import INSTANT, align_curve, static_level
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.metrics import rms
from jointwave.compare.misfit.places import Place
from jointwave.compare.studies.elements import period_of
from jointwave.compare.studies.fit_keys import CLOCK, ORIGIN, FreeKey, changed

FINER = 4  # samples of the solution per sample of the scene, if the clock is free
EXACT_STEP, COMPUTED_STEP = 1e-4, 1e-3  # of an unknown, for differences
LEAST_SAMPLES = 10  # of a waveform
TOLERANCE = 1e-12  # of the squares, the unknowns and the gradient
MOST = 60  # steps of a search, each with its derivatives


class Measured(NamedTuple):
    """One measured waveform [n] at times [n] in s on its file's own clock, SI; size : root mean
    square of its motion, less the solution's value before its load."""

    name: str
    place: Place
    time: np.ndarray
    values: np.ndarray
    size: float


@dataclass
class Trials:
    """Solutions of a scene for values of its free keys, beside the measured waveforms.

    scene : with the sampling and duration that the fit needs. count : of the solutions tried.
    """

    scene: AnyScene
    solver: str
    keys: list[FreeKey]
    measured: list[Measured]
    progress: Progress | None
    count: int = 0

    def search(self) -> Any:
        """Return lmfit's result; None if the search does not converge."""
        given = Parameters()
        for i, key in enumerate(self.keys):
            low, start, high = map(key.unknown, (key.low, key.start, key.high))
            given.add(f"key_{i}", start, min=low, max=high)
        step = COMPUTED_STEP if self.solver in ENGINES else EXACT_STEP
        options: dict[str, Any] = {"jac": "3-point", "diff_step": step / ORIGIN, "x_scale": "jac"}
        options |= dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE)
        options["max_nfev"] = MOST * (2 * len(self.keys) + 1)
        try:
            found = minimize(
                self._residuals, given, method="least_squares", nan_policy="propagate", **options
            )
        except ValueError:  # no derivative: a neighbour has no solution
            return None
        return found if found.success else None

    def _residuals(self, unknowns: Parameters) -> np.ndarray:
        """Return all residuals in one; infinite without a solution, so that the search takes its
        step back."""
        try:
            return np.concatenate(self.residuals(list(unknowns.valuesdict().values())))
        except (SceneError, UnstableError):
            return np.full(sum(len(m.time) for m in self.measured), inf)

    def residuals(self, x: Iterable[float]) -> list[np.ndarray]:
        """Return solution minus measurement [n] of each waveform, whose norm is its relative L2
        misfit, for the search variables [p]; raises SceneError or UnstableError if there is no
        solution."""
        self.count += 1
        if self.progress:
            self.progress(1 - 0.97**self.count)  # the number of trials is unknown
        values = {key.key: key.value(u) for key, u in zip(self.keys, x, strict=True)}
        shift = values.pop(CLOCK, 0.0)
        result = solve(self.solver, changed(self.scene, values))
        time, found = result.time.values, []
        for one in self.measured:
            at = np.clip(one.time + shift, time[0], time[-1])  # at rest before its first sample
            off = CubicSpline(time, one.place.waveform(result))(at) - one.values
            found.append(off / (one.size * np.sqrt(len(off))))
        return found


def started(clock: FreeKey, scene: AnyScene, solver: str, curve: Curves) -> FreeKey:
    """Return the clock with its start, unless given the shift with the best correlation of a file
    to the solution, and with bounds a period of the load away at most."""
    start, reach = clock.start, period_of(scene)
    if isnan(start):
        found = align_curve(curve, scene, {solver: solve(solver, scene)}, align=True).shift
        start = found.seconds if found else 0.0
    low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    return clock._replace(start=start, low=low, high=high)


def trials_of(
    scene: AnyScene,
    solver: str,
    curves: Sequence[Curves],
    keys: list[FreeKey],
    progress: Progress | None = None,
) -> Trials:
    """Return the trials of a fit; raises SceneError if a curve shares too few samples."""
    shift = next((key.start for key in keys if key.key == CLOCK), None)
    interval = scene.interval / (FINER if shift is not None else 1)
    record = scene.record.model_copy(update={"interval": interval, "energy": False, "fields": None})
    longer = scene.time.duration + (0.0 if shift is None else period_of(scene))
    clock = scene.time.model_copy(update={"duration": longer})
    base = scene.model_copy(update={"record": record, "time": clock, "expect": {}})
    result, end = solve(solver, base), scene.time.duration + 1e-6 * scene.interval
    measured = []
    for one in curves:
        own = one.time + (shift or 0.0)
        inside = (own >= -INSTANT) & (own <= end)
        for place, values in one.waveforms.items():
            if place.waveform(result) is None:
                continue
            if inside.sum() < LEAST_SAMPLES:
                allowed = (
                    f"must share at least {LEAST_SAMPLES} samples with the scene, 0 to "
                    f"{scene.time.duration:g} s, not {inside.sum()}; --free clock shifts its time"
                )
                raise SceneError(one.name, str(place), None, allowed)
            size = rms(values[inside] - static_level(place, result)) or 1.0
            measured.append(Measured(one.name, place, one.time[inside], values[inside], size))
    if not measured:
        raise SceneError(curves[0].file, "", None, "has no waveform at a receiver of the scene")
    return Trials(base, solver, keys, measured, progress)
