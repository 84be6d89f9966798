"""From a scene to its result by the continuum engine."""

import json
from collections.abc import Callable
from time import perf_counter

import numba
import numpy as np
import xarray as xr

from cases.calibrate import Properties, calibrate
from cases.effects import is_spatial
from cases.errors import SceneError, UnstableError
from cases.result import dataset
from cases.sampling import Clock
from cases.scene import Scene
from continuum import compat
from continuum.build import build
from continuum.explicit import run
from continuum.model import Model, Samples, State, room

MODELS = ("jointed", "equivalent")
NODE_STEPS_BETWEEN_LOOKS = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_LOOKS = 20  # so that a runaway motion is dated to a twentieth of the scene
RUNAWAY = 100  # times the highest speed that the load can cause


def applies(scene: Scene, model: str = "jointed") -> str:
    """Return "" where this model can simulate the scene, else the reason why not."""
    p = calibrate(scene)
    reason = _beyond_the_bar(scene, p)
    if reason:
        return reason
    if model == "jointed":
        return "" if p.intact_modulus else "the jointed rock needs rock.intact_modulus"
    excess = p.excess_compliance
    if not p.tension[excess == 0].all():
        return "a homogenised bar has no joints to open where tension is barred"
    if (excess < 0).any():
        return "a joint stiffer than the others cannot be added to the homogenised bar"
    if p.damps_alone.any():
        return "a homogenised bar cannot damp one ordinary joint by itself"
    return ""


def _beyond_the_bar(scene: Scene, p: Properties) -> str:
    if is_spatial(scene):
        return "the bar has no motion across its axis"
    if p.tensile_strength is not None:
        return "its joints have no tensile strength that softens"
    if scene.gravity is not None:
        return "the bar has no weight"
    if scene.prestress is not None:
        return "the bar has no stress before the load"
    if p.mass_damping is not None or p.local_damping is not None:
        return "the bar is damped by its strain rate alone"
    if scene.ends.start == "fixed":
        return "the loaded end of the bar can be neither fixed nor shaken"
    return ""


def simulate(
    scene: Scene,
    model: str = "jointed",
    dim: int = 1,
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Simulate a scene as deformable rock.

    Parameters
    ----------
    model : "jointed" (intact rock, every joint an interface) or "equivalent" (homogenised bar,
        soft layers as interfaces of their excess compliance).
    dim : 1, the bar.
    progress : called with the finished fraction.

    Raises SceneError for what this model cannot simulate, UnstableError when the motion runs away.
    """
    refuse(scene, model, dim)
    began = perf_counter()
    built, state, time, critical = build(scene, model)
    samples = room(built, state, time.samples)
    ready = perf_counter()
    run(built, state, samples, time.stride, 0, 0)
    compiled = perf_counter()
    _run(built, state, samples, time, critical, progress)
    return dataset(
        scene,
        f"continuum-{model}",
        time.times,
        samples.stress,
        samples.velocity,
        samples.displacement,
        samples.energy,
        model=model,
        scheme="explicit",
        dim=dim,
        order=scene.numerics.continuum.order,
        dt=time.dt,
        critical_dt=critical,
        steps=time.steps,
        degrees_of_freedom=state.u.size,
        seconds_setup=ready - began,
        seconds_compile=compiled - ready,
        seconds_stepping=perf_counter() - compiled,
        versions=json.dumps(
            {"numpy": np.__version__, "numba": numba.__version__, "dolfinx": compat.VERSION}
        ),
    )


def refuse(scene: Scene, model: str, dim: int) -> None:
    """Raise SceneError for what is not built or does not fit the model."""
    where = scene.name or scene.title
    if model not in MODELS:
        raise SceneError(where, "model", model, f"must be one of {', '.join(MODELS)}")
    if dim != 1:
        raise SceneError(where, "dim", dim, "not available yet")
    if compat.process_count() > 1:
        raise SceneError(where, "MPI processes", compat.process_count(), "not available yet")
    reason = applies(scene, model)
    if reason:
        raise SceneError(where, "model", model, reason)


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
    """Return a bound on the speed of any node, m/s.

    No part of the model puts energy in, so d sqrt(2 E) / dt is at most |F| / sqrt(m) of the loaded
    node, and m v^2 of any node at most 2 E.
    """
    mass = model.rock.mass
    impulse = model.dt * np.abs(model.load).sum()
    return float(impulse / np.sqrt(mass[model.ends.loaded] * mass.min()))
