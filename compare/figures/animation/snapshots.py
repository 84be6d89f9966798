"""Both engines' snapshots of one scene, at the instants of a picture or an animation."""

from math import ceil
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene, checked
from jointwave.cases.schema.tables import Time
from jointwave.compare.engines import ENGINES, Progress, applies, solve
from jointwave.compare.figures.units import UNITS
from jointwave.compare.solvers.dem import DEM
from jointwave.results.snapshots import Snapshots, snapshots_of


class SceneSnapshots(NamedTuple):
    """One scene with each engine's snapshots.

    scene : of either kind, with the instants in its record. found : by engine, all at the same
    instants. reasons : by engine, why it has none. results : by engine, with the waveforms as
    recorded.
    """

    scene: Any
    found: dict[str, Snapshots]
    reasons: dict[str, str]
    results: dict[str, xr.Dataset]

    @property
    def time(self) -> np.ndarray:
        """The instants, s."""
        return next(iter(self.found.values())).time

    @property
    def title(self) -> str:
        """Title and variant of the scene."""
        return ", ".join(part for part in (self.scene.title, self.scene.name) if part)

    @property
    def missing(self) -> list[str]:
        """A sentence for each engine that does not apply."""
        return [f"{name} does not apply: {why}" for name, why in self.reasons.items()]


def at_instants(scene: AnyScene, count: int) -> AnyScene:
    """Return the scene with `count` snapshots, the first at t = 0 and the last at its end.

    The waveforms are sampled at least as often as before.
    """
    between = scene.time.duration / (count - 1)
    interval = between / max(1, ceil(between / scene.interval - 1e-9))
    changes = {"fields": between, "interval": interval}
    return checked(scene.model_copy(update={"record": scene.record.model_copy(update=changes)}))


def until(scene: AnyScene, time: float) -> AnyScene:
    """Return the scene shortened to `time`, s."""
    return checked(scene.model_copy(update={"time": Time(duration=time)}))


def take(scene: AnyScene, count: int, progress: Progress | None = None) -> SceneSnapshots:
    """Simulate a scene with both engines and return `count` snapshots of each.

    Their stress is that of the motion, minus the static state. The rock is jointed if that model
    applies, else homogenised. Raises SceneError and UnstableError as the engines do, and SceneError
    if none applies.
    """
    if count < 2:
        raise SceneError("snapshots", "", count, "must be at least 2")
    asked, chosen, reasons = at_instants(scene, count), list[str](), {}
    for names in ([DEM.name], [engine for engine in ENGINES if engine != DEM.name]):
        for name in names:
            if answer := applies(name, asked):
                chosen.append(name)
                break
            reasons[name] = answer.reason
    if not chosen:
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
        raise SceneError(scene.where, "", None, f"no engine has snapshots of it: {why}")
    found, results = {}, {}
    for i, name in enumerate(chosen):
        result = solve(name, asked, _part(progress, i, len(chosen)))
        taken = snapshots_of(result)
        assert taken is not None
        stress = None if taken.stress is None else _less_static(result, taken.stress)
        found[name] = taken._replace(stress=stress)
        results[name] = result[[q for q in UNITS if q in result]]
    return SceneSnapshots(asked, found, {} if len(found) > 1 else reasons, results)


def _less_static(result: xr.Dataset, stress: np.ndarray) -> np.ndarray:
    """Return the axial stress of the motion, as `compare.misfit.metrics.motion` does for
    waveforms."""
    if result.attrs.get("starts") == "at rest under gravity":
        return stress - stress[:1]
    return stress - result.attrs.get("prestress", 0.0)


def _part(progress: Progress | None, i: int, count: int) -> Progress | None:
    """Return the progress callback of the i-th of `count` runs."""
    if progress is None:
        return None
    return lambda fraction: progress((i + fraction) / count)
