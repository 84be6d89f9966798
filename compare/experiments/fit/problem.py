"""The problem of a fit: waveforms of a solution at the times of measured ones, key by key."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cases.errors import SceneError, UnstableError
from cases.kinds import AnyScene
from cases.schema.pulse import shortest_period
from cases.schema.scene import Scene
from compare.engines import ENGINES, applies, solve
from compare.exact.blocks import lattice
from compare.experiments.common import FAILURES
from compare.experiments.fit.keys import CLOCK, changed
from compare.experiments.planner.families import COARSEST
from compare.misfit.alignment import INSTANT, static_level
from compare.misfit.external import Curves, is_recorded
from compare.misfit.places import Place
from compare.solvers.dem import DEM

SHORT = 200  # blocks, up to which matrix exponentials are cheap
FINER = 4  # samples of the solution per sample of the scene, if the clock is free
EXACT_STEP, COMPUTED_STEP = 1e-4, 1e-3  # of an unknown, for differences


class Measured(NamedTuple):
    """One measured waveform [n] at times [n] in s on its file's own clock, SI; `static` is the
    solution's value there before its load."""

    name: str
    place: Place
    time: np.ndarray
    values: np.ndarray
    static: float

    @property
    def size(self) -> float:
        """Root mean square of the motion."""
        return float(np.sqrt(np.mean((self.values - self.static) ** 2))) or 1.0


@dataclass(frozen=True)
class Problem:
    """A scene, its solver, and the waveforms to fit.

    scene : with the sampling and duration that the fit needs. steps : of rigid blocks per sample,
    the same in every trial, so that waveforms vary smoothly with a key; 0 without steps.
    """

    scene: AnyScene
    solver: str
    measured: list[Measured]
    steps: int = 0

    def residual(self, values: Mapping[str, float]) -> list[np.ndarray] | None:
        """Return solution minus measurement [n] of each waveform; None without a solution."""
        from scipy.interpolate import CubicSpline

        try:
            scene = changed(self.scene, {k: v for k, v in values.items() if k != CLOCK})
            result = solve(self.solver, self._stepped(scene))
        except FAILURES:
            return None
        time, found = result.time.values, []
        for one in self.measured:
            ours = one.place.waveform(result)
            assert ours is not None
            # At rest before its first sample.
            at = np.clip(one.time + values.get(CLOCK, 0.0), time[0], time[-1])
            found.append(CubicSpline(time, ours)(at) - one.values)
        return found

    @property
    def step(self) -> float:
        """The increment of an unknown for finite differences."""
        return COMPUTED_STEP if self.solver in ENGINES else EXACT_STEP

    def _stepped(self, scene: AnyScene) -> AnyScene:
        if not self.steps:
            return scene
        fraction = scene.interval / self.steps / DEM.prepare(scene).critical
        if fraction > COARSEST:
            raise UnstableError("the initial step exceeds the critical step of this trial")
        step = {"step_fraction": fraction * (1 + 1e-6)}  # otherwise rounding adds a step
        dem = scene.numerics.dem.model_copy(update=step)
        return scene.model_copy(update={"numerics": scene.numerics.model_copy(update={"dem": dem})})


def solver_of(scene: AnyScene, asked: str | None) -> str:
    """Return the solver of every trial: the requested one, else rigid blocks, exact in time if they
    are linear and few; raises SceneError if it does not apply."""
    if asked is None and isinstance(scene, Scene) and scene.block_count <= SHORT:
        asked = lattice.SOLVER.name if lattice.applies(scene) else None
    name = asked or DEM.name
    answer = applies(name, scene)
    if not answer:
        raise SceneError(scene.where, "", None, f"{name} does not apply: {answer.reason}")
    return name


def problem_of(
    scene: AnyScene, name: str, curves: list[Curves], clock: float | None, reach: float
) -> Problem:
    """Return the problem of a fit.

    name : of the solver. clock : initial shift, s; None: fixed clock.
    reach : largest later shift of the clock, s, by which the solution extends beyond the scene.
    Raises SceneError if a curve shares fewer samples with the scene than a fit needs.
    """
    moves, shift = clock is not None, clock or 0.0
    interval = scene.interval / (FINER if moves else 1)
    record = scene.record.model_copy(update={"interval": interval, "energy": False, "fields": None})
    time = scene.time.model_copy(update={"duration": scene.time.duration + reach})
    base = scene.model_copy(update={"record": record, "time": time, "expect": {}})
    result = solve(name, base)
    found = []
    for one in curves:
        own = one.time + shift
        inside = (own >= -INSTANT) & (own <= scene.time.duration + 1e-6 * scene.interval)
        for place, values in one.waveforms.items():
            if not is_recorded(place, scene) or place.waveform(result) is None:
                continue
            level = static_level(place, result)
            found.append(Measured(one.name, place, one.time[inside], values[inside], level))
    _require_samples(found, curves, scene)
    steps = round(interval / float(result.attrs["dt"])) if name == DEM.name else 0
    return Problem(base, name, found, steps)


def _require_samples(found: list[Measured], curves: list[Curves], scene: AnyScene) -> None:
    if not found:
        raise SceneError(curves[0].file, "", None, "has no waveform at a receiver of the scene")
    for one in found:
        if len(one.time) < 10:
            allowed = (
                f"must share at least 10 samples with the scene, 0 to {scene.time.duration:g} s, "
                f"not {len(one.time)}; --free clock shifts its time"
            )
            raise SceneError(one.name, str(one.place), None, allowed)


def started_clock(scene: AnyScene, solver: str, curves: list[Curves]) -> float:
    """Return the shift of the first file's clock with the best correlation to the solution, s."""
    from compare.misfit.alignment import lay_beside

    shift = lay_beside(curves[0], scene, {solver: solve(solver, scene)}, align=True).shift
    return shift.seconds if shift else 0.0


def clock_reach(scene: AnyScene) -> float:
    """Return the largest shift of a clock from its start, s: a period of the load."""
    return shortest_period(scene.pulses) or scene.time.duration / 10
