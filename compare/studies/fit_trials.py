"""Solutions of a scene for values of its free keys, beside the measured waveforms of a fit."""

from dataclasses import dataclass
from math import inf, isnan
from typing import Any, NamedTuple

import numpy as np
from lmfit import Parameters, minimize
from scipy.interpolate import CubicSpline

from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, Progress, applies, solve
from jointwave.compare.exact.blocks import lattice
from jointwave.compare.misfit.alignment import INSTANT, align_curve, static_level
from jointwave.compare.misfit.external import Curves, is_recorded
from jointwave.compare.misfit.metrics import rms
from jointwave.compare.misfit.places import Place
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies.fit_keys import CLOCK, ORIGIN, FreeKey, changed

SHORT = 200  # blocks, up to which matrix exponentials are cheap
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

    scene : with the sampling and duration that the fit needs. count, refused : of the solutions
    tried, and of those that do not exist.
    """

    scene: AnyScene
    solver: str
    keys: list[FreeKey]
    measured: list[Measured]
    tell: Progress
    count: int = 0
    refused: int = 0

    def values(self, x: np.ndarray) -> dict[str, float]:
        """Return the value of each key for the search variables [p]."""
        return {k.key: k.value(u) for k, u in zip(self.keys, x.tolist(), strict=True)}

    def residuals(self, x: np.ndarray) -> list[np.ndarray] | None:
        """Return solution minus measurement [n] of each waveform, SI; None without a solution."""
        self.count += 1
        self.tell(1 - 0.97**self.count)  # the number of trials is unknown
        values = self.values(x)
        shift = values.pop(CLOCK, 0.0)
        try:
            result = solve(self.solver, changed(self.scene, values))
        except (SceneError, UnstableError):
            self.refused += 1
            return None
        time, found = result.time.values, []
        for one in self.measured:
            at = np.clip(one.time + shift, time[0], time[-1])  # at rest before its first sample
            found.append(CubicSpline(time, one.place.waveform(result))(at) - one.values)
        return found

    def misfits(self, residuals: list[np.ndarray]) -> list[float]:
        """Return the relative L2 misfit of each waveform, of the measured motion."""
        return [rms(r) / m.size for r, m in zip(residuals, self.measured, strict=True)]

    def worst(self, x: np.ndarray) -> float:
        """Return the largest misfit; infinite without a solution."""
        found = self.residuals(x)
        return inf if found is None else max(self.misfits(found))

    def search(self, start: np.ndarray) -> Any:
        """Return lmfit's result from a start; None if the search does not converge."""

        def weighted(p: Parameters) -> np.ndarray:
            found = self.residuals(np.array(list(p.valuesdict().values())))
            if found is None:  # such a step is taken back
                return np.full(sum(len(m.time) for m in self.measured), inf)
            pairs = zip(found, self.measured, strict=True)
            return np.concatenate([r / (m.size * np.sqrt(len(r))) for r, m in pairs])

        given = Parameters()
        for i, (key, value) in enumerate(zip(self.keys, start, strict=True)):
            given.add(f"key_{i}", value, min=key.unknown(key.low), max=key.unknown(key.high))
        step = COMPUTED_STEP if self.solver in ENGINES else EXACT_STEP
        options = {"jac": "3-point", "diff_step": step / ORIGIN, "x_scale": "jac"}
        options |= dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE)
        options["max_nfev"] = MOST * (2 * len(start) + 1)
        try:
            found = minimize(
                weighted, given, method="least_squares", nan_policy="propagate", **options
            )
        except ValueError:  # no derivative: a neighbour has no solution
            return None
        return found if found.success else None


def solver_of(scene: AnyScene, asked: str | None) -> str:
    """Return the solver of every trial; raises SceneError if it does not apply."""
    if asked is None and isinstance(scene, Scene) and scene.block_count <= SHORT:
        asked = lattice.SOLVER.name if lattice.applies(scene) else None
    name = asked or DEM.name
    answer = applies(name, scene)
    if not answer:
        raise SceneError(scene.where, "", None, f"{name} does not apply: {answer.reason}")
    return name


def started(clock: FreeKey, scene: AnyScene, solver: str, curves: list[Curves]) -> FreeKey:
    """Return the clock with its start, unless given the shift with the best correlation of the
    first file to the solution, and with bounds within its reach."""
    start, reach = clock.start, _clock_reach(scene)
    if isnan(start):
        found = align_curve(curves[0], scene, {solver: solve(solver, scene)}, align=True).shift
        start = found.seconds if found else 0.0
    low, high = max(clock.low, start - reach), min(clock.high, start + reach)
    return clock._replace(start=start, low=low, high=high)


def _clock_reach(scene: AnyScene) -> float:
    """Return the largest shift of a clock from its start, s: a period of the load."""
    return shortest_period(scene.pulses) or scene.time.duration / 10


def trials_of(
    scene: AnyScene, name: str, curves: list[Curves], keys: list[FreeKey], tell: Progress
) -> Trials:
    """Return the trials of a fit; raises SceneError if a curve shares too few samples."""
    shift = next((key.start for key in keys if key.key == CLOCK), None)
    interval = scene.interval / (FINER if shift is not None else 1)
    record = scene.record.model_copy(update={"interval": interval, "energy": False, "fields": None})
    longer = scene.time.duration + (0.0 if shift is None else _clock_reach(scene))
    clock = scene.time.model_copy(update={"duration": longer})
    base = scene.model_copy(update={"record": record, "time": clock, "expect": {}})
    result = solve(name, base)
    measured = []
    for one in curves:
        own = one.time + (shift or 0.0)
        inside = (own >= -INSTANT) & (own <= scene.time.duration + 1e-6 * scene.interval)
        for place, whole in one.waveforms.items():
            if is_recorded(place, scene) and place.waveform(result) is not None:
                time, values = one.time[inside], whole[inside]
                size = rms(values - static_level(place, result)) or 1.0
                measured.append(Measured(one.name, place, time, values, size))
    _require_samples(measured, curves, scene)
    return Trials(base, name, keys, measured, tell)


def _require_samples(measured: list[Measured], curves: list[Curves], scene: AnyScene) -> None:
    if not measured:
        raise SceneError(curves[0].file, "", None, "has no waveform at a receiver of the scene")
    for one in measured:
        if len(one.time) < LEAST_SAMPLES:
            allowed = (
                f"must share at least {LEAST_SAMPLES} samples with the scene, 0 to "
                f"{scene.time.duration:g} s, not {len(one.time)}; --free clock shifts its time"
            )
            raise SceneError(one.name, str(one.place), None, allowed)
