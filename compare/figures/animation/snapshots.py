"""Both engines' snapshots of one scene, at the instants of a picture or an animation."""

from math import ceil
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.validate import checked
from jointwave.compare.engines import ENGINES, Progress, applies
from jointwave.compare.figures.style import UNITS
from jointwave.compare.misfit.metrics import motion
from jointwave.compare.runs.reuse import NOWHERE, SNAPSHOTS, ResultFolder
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


def take(
    scene: AnyScene,
    interval: float | None,
    progress: Progress | None = None,
    stored: ResultFolder = NOWHERE,
) -> SceneSnapshots:
    """Simulate a scene with both engines and return snapshots of each, one per interval, s.

    interval : None: those that the scene records itself. stored : a folder of results. The stress
    is that of the motion, minus the static state. The rock is jointed if that model applies, else
    homogenised. Raises SceneError and UnstableError as the engines do, and SceneError if none
    applies.
    """
    asked = scene if interval is None else with_snapshots(scene, interval)
    shown = shown_engines(asked)
    reasons = {name: answer.reason for name in ENGINES if not (answer := applies(name, asked))}
    if not shown:
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
        raise SceneError(scene.where, "", None, f"no engine has snapshots of it: {why}")
    found, results = {}, {}
    for name, result in stored.solve(shown, asked, progress, "" if interval is None else SNAPSHOTS):
        taken = snapshots_of(result)
        assert taken is not None
        if taken.stress is not None:
            field = result[["field_stress"]].rename(field_time="time", field_stress="stress")
            taken = taken._replace(stress=motion(field)["stress"].values)
        found[name] = taken
        results[name] = result[[q for q in UNITS if q in result]]
    return SceneSnapshots(asked, found, {} if len(found) > 1 else reasons, results)


def shown_engines(scene: AnyScene) -> list[str]:
    """Return the rigid blocks and the model of the rock that are shown, those that apply."""
    return [name for name in ENGINES if applies(name, scene)][:2]


def with_snapshots(scene: AnyScene, interval: float) -> AnyScene:
    """Return a scene that records snapshots at an interval, s, and samples at least as often."""
    between = interval / max(1, ceil(interval / scene.interval - 1e-9))
    record = scene.record.model_copy(update={"fields": interval, "interval": between})
    return checked(scene.model_copy(update={"record": record}))
