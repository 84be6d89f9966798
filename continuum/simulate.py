"""From a scene to its result by the continuum engine."""

import json
from collections.abc import Callable
from time import perf_counter

import numba
import numpy as np
import xarray as xr

from cases.errors import SceneError, UnstableError
from cases.result import dataset
from cases.sampling import Clock, clock
from cases.scene import Scene
from continuum import compat
from continuum.build import (
    Discrete,
    build_model,
    critical_step_of,
    discretise,
    room,
    state_at_rest,
)
from continuum.explicit import run
from continuum.kinematics import refuse
from continuum.model import Model, Samples, State
from continuum.reach import applies
from continuum.waveforms import energy_terms, waveforms

NODE_STEPS_BETWEEN_LOOKS = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_LOOKS = 20  # so that a runaway motion is dated to a twentieth of the scene
RUNAWAY = 100  # times the highest speed that the load can cause


def simulate(
    scene: Scene,
    model: str = "jointed",
    dim: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Simulate a scene as deformable rock.

    Parameters
    ----------
    model : "jointed" (intact rock, every joint an interface) or "equivalent" (homogenised rock
        mass, soft layers as interfaces of their excess compliance).
    dim : 1, the bar; 2, plane stress; 3, the square column; None leaves it to the scene.
    progress : called with the finished fraction.

    Raises SceneError for what this model cannot simulate, UnstableError when the motion runs away.
    """
    refuse(scene, model, dim)
    reason = applies(scene, model, dim)
    if reason:
        raise SceneError(scene.name or scene.title, "model", model, reason)
    began = perf_counter()
    numerics = scene.numerics.continuum
    discrete = discretise(scene, model, dim)
    time, critical = _steps(scene, discrete, model)
    built = build_model(scene, discrete, model, time)
    state = state_at_rest(built, scene.record.energy)
    samples = room(built, state, time.samples)
    ready = perf_counter()
    run(built, state, samples, time.stride, 0, 0)
    compiled = perf_counter()
    _run(built, state, samples, time, critical, progress)
    stepped = perf_counter()
    terms, energy = energy_terms(built, samples.energy)
    return dataset(
        scene,
        f"continuum-{model}",
        time.times,
        **waveforms(scene, discrete, samples),
        energy=energy,
        terms=terms,
        model=model,
        scheme="explicit",
        dim=discrete.kinematics.dim,
        order=numerics.order,
        dt=time.dt,
        critical_dt=critical,
        steps=time.steps,
        degrees_of_freedom=discrete.body.degrees_of_freedom,
        seconds_setup=ready - began,
        seconds_compile=compiled - ready,
        seconds_stepping=stepped - compiled,
        versions=json.dumps(
            {"numpy": np.__version__, "numba": numba.__version__, "dolfinx": compat.VERSION}
        ),
    )


def steps_of(scene: Scene, model: str, dim: int | None = None) -> tuple[Clock, float]:
    """Return the clock and the critical step (s) of a scene."""
    return _steps(scene, discretise(scene, model, dim), model)


def _steps(scene: Scene, discrete: Discrete, model: str) -> tuple[Clock, float]:
    numerics = scene.numerics.continuum
    critical = critical_step_of(scene, discrete, model)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "continuum")
    return time, critical


def _run(
    model: Model,
    state: State,
    samples: Samples,
    time: Clock,
    critical: float,
    progress: Callable[[float], None] | None,
) -> None:
    limit = RUNAWAY * highest_speed(model)
    chunk = NODE_STEPS_BETWEEN_LOOKS // (state.u.size * time.stride)
    chunk = max(1, min(chunk, time.samples // LEAST_LOOKS))
    step = 0
    for first in range(0, time.samples, chunk):
        last = min(first + chunk, time.samples)
        # Up to the step of the last sample: what follows it belongs to the next chunk.
        end = (last - 1) * time.stride + 1
        run(model, state, samples, time.stride, step, end)
        step = end
        if not np.abs(state.v).max() <= limit:
            raise UnstableError(
                f"the continuum runs away before t = {step * time.dt:.4g} s "
                f"(step {time.dt:.4g} s, critical {critical:.4g} s)"
            )
        if progress:
            progress(last / time.samples)


def highest_speed(model: Model) -> float:
    """Return a bound on the speed of any node, m/s; the largest number where none is known.

    Where a load on the start is all that puts energy in, d sqrt(2 E) / dt is at most |F| in the
    norm of 1 / m, and m v^2 of any node at most 2 E.
    """
    loaded, held = model.ends.loaded, model.ends.held
    shaken = held is not None and held.step is not None
    if loaded is None or shaken or model.weight is not None:
        return float(np.finfo(float).max) / RUNAWAY
    mass = model.rock.mass
    impulse = model.dt * np.abs(loaded.pressure).sum()
    drive = np.sqrt((loaded.share**2 / mass[loaded.freedom]).sum())
    return float(impulse * drive / np.sqrt(mass[mass > 0].min()))
