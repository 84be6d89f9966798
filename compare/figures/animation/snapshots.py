"""Both engines' snapshots of one scene, at the instants of a picture or an animation."""

from math import ceil
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene, checked
from jointwave.compare.engines import ENGINES, Progress, applies, solve
from jointwave.compare.figures.units import UNITS
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


def take(scene: AnyScene, interval: float, progress: Progress | None = None) -> SceneSnapshots:
    """Simulate a scene with both engines and return snapshots of each, one per interval, s.

    Their stress is that of the motion, minus the static state. The rock is jointed if that model
    applies, else homogenised. Raises SceneError and UnstableError as the engines do, and SceneError
    if none applies.
    """
    between = interval / max(1, ceil(interval / scene.interval - 1e-9))  # sampled at least as often
    record = scene.record.model_copy(update={"fields": interval, "interval": between})
    asked = checked(scene.model_copy(update={"record": record}))
    answers = {name: applies(name, asked) for name in ENGINES}
    shown = [name for name, answer in answers.items() if answer][:2]
    reasons = {name: answer.reason for name, answer in answers.items() if not answer}
    if not shown:
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
        raise SceneError(scene.where, "", None, f"no engine has snapshots of it: {why}")
    found, results = {}, {}
    for i, name in enumerate(shown):

        def part(fraction: float, i: int = i) -> None:
            if progress is not None:
                progress((i + fraction) / len(shown))

        result = solve(name, asked, part)
        taken = snapshots_of(result)
        assert taken is not None
        found[name] = taken._replace(stress=_less_static(result, taken.stress))
        results[name] = result[[q for q in UNITS if q in result]]
    return SceneSnapshots(asked, found, {} if len(found) > 1 else reasons, results)


def _less_static(result: xr.Dataset, stress: np.ndarray | None) -> np.ndarray | None:
    """Return the axial stress of the motion, as `compare.misfit.metrics.motion` does for
    waveforms."""
    if stress is None:
        return None
    if result.attrs.get("starts") == "at rest under gravity":
        return stress - stress[:1]
    return stress - result.attrs.get("prestress", 0.0)
