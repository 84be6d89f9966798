"""From a scene to its result by the rigid-block engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING

import numba
import numpy as np

from cases.errors import UnstableError
from cases.result import Fields, fields
from cases.sampling import Clock
from cases.scene import Scene
from dem.model import Model, State, build
from dem.record import Samples, room, run

if TYPE_CHECKING:
    import xarray as xr

BLOCK_STEPS_BETWEEN_LOOKS = 20_000_000  # some 10 ms: often enough for a progress bar


def simulate(scene: Scene, progress: Callable[[float], None] | None = None) -> xr.Dataset:
    """Simulate a scene with rigid blocks.

    `progress` is called with the finished fraction. Raises SceneError for a step that cannot be
    taken and UnstableError when the motion is no longer finite.
    """
    import xarray as xr

    return xr.Dataset(*simulate_fields(scene, progress))


def simulate_fields(scene: Scene, progress: Callable[[float], None] | None = None) -> Fields:
    """Simulate a scene as `simulate` does, and return the result as plain arrays."""
    began = perf_counter()
    model, state, time, critical = build(scene)
    samples = room(model, state, time.samples)
    built = perf_counter()
    run(model, state, samples, time.stride, 0, 0)
    compiled = perf_counter()
    _run(model, state, samples, time, critical, progress)
    return fields(
        scene,
        "dem",
        time.times,
        samples.stress,
        samples.velocity,
        samples.displacement,
        samples.energy,
        model="rigid blocks",
        scheme=scene.numerics.dem.scheme,
        dt=time.dt,
        critical_dt=critical,
        steps=time.steps,
        degrees_of_freedom=state.u.size,
        seconds_setup=built - began,
        seconds_compile=compiled - built,
        seconds_stepping=perf_counter() - compiled,
        versions=json.dumps({"numpy": np.__version__, "numba": numba.__version__}),
    )


def _run(
    model: Model,
    state: State,
    samples: Samples,
    time: Clock,
    critical: float,
    progress: Callable[[float], None] | None,
) -> None:
    chunk = max(1, BLOCK_STEPS_BETWEEN_LOOKS // (state.u.size * time.stride))
    for first in range(0, time.samples, chunk):
        last = min(first + chunk, time.samples)
        run(model, state, samples, time.stride, first, last)
        if not np.isfinite(state.u).all():
            raise UnstableError(
                "the rigid blocks are no longer finite at "
                f"t = {last * time.stride * time.dt:.4g} s "
                f"(step {time.dt:.4g} s, critical {critical:.4g} s)"
            )
        if progress:
            progress(last / time.samples)
