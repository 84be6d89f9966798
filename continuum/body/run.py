"""From a scene of a rock mass to its result by the dolfinx body."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter

import dolfinx
import numba
import numpy as np
import xarray as xr

from jointwave.cases.errors import StoppedError
from jointwave.cases.incident import IncidentField
from jointwave.cases.material.prestress import refuse_beyond_strength
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.body.bounds import highest_speed
from jointwave.continuum.body.explicit import Samples
from jointwave.continuum.body.problem import problem_of
from jointwave.continuum.body.rock import Rock
from jointwave.continuum.body.scene import body_of
from jointwave.continuum.body.steps import Leapfrog, Problem
from jointwave.numerics.divergence import ENERGY, Guard, audit, guard, look
from jointwave.numerics.instability import Divergence, stopped
from jointwave.numerics.time_loop import Checkpointer, run_in_chunks
from jointwave.results.arrays import size_of
from jointwave.results.rock_mass import rock_mass_dataset

FREEDOM_STEPS_AT_ONCE = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_CHUNKS = 20  # however short the run


def simulate(
    scene: RockMass,
    model: str = "jointed",
    rock: Rock | None = None,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
    incident: IncidentField | None = None,
) -> xr.Dataset:
    """Simulate a rock mass as deformable rock.

    Parameters
    ----------
    model : "jointed", every joint an interface, or "equivalent", joints with a spacing in an
        effective medium.
    rock : function of the scene and a dolfinx space that returns the rock as UFL forms, in place of
        the scene's own.
    progress : called with the finished fraction.
    keeper : of checkpoints, `numerics.time_loop`.
    incident : of the waves, as if the rock had no sides; absent: in rock without joints.

    Raises SceneError for what cannot be simulated; StoppedError, with the result so far, when the
    motion leaves its bounds.
    """
    began = perf_counter()
    refuse_beyond_strength(scene)
    found = body_of(scene, model, rock)
    still, numerics = problem_of(scene, found), scene.numerics.continuum
    critical = still.critical_step()
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "continuum")
    problem = problem_of(scene, found, time, incident)
    steps = Leapfrog(problem, time.dt, time.samples, scene.record.energy)
    built = perf_counter()
    steps.take(0, 0, time.stride)
    compiled = perf_counter()
    monitor = guard(highest_speed(scene, found, problem, time))

    def result(count: int) -> xr.Dataset:
        return rock_mass_dataset(
            scene,
            f"continuum-{model}",
            time.times[:count],
            quantities(problem, steps.samples, count),
            steps.samples.energy[:, :count] if scene.record.energy else None,
            model=model,
            scheme="explicit",
            dt=time.dt,
            critical_dt=critical,
            steps=time.steps,
            order=numerics.order,
            degrees_of_freedom=len(problem.body.stiffness.indptr) - 1,
            bytes=size_of(steps.constants, steps.state, steps.work),
            seconds_setup=built - began,
            seconds_compile=compiled - built,
            seconds_stepping=perf_counter() - compiled,
            versions=versions(),
        )

    def march(first: int, last: int) -> None:
        steps.take(first * time.stride, last * time.stride, time.stride)
        check(scene, steps, monitor, time, critical, first, last)

    chunk = FREEDOM_STEPS_AT_ONCE // (problem.body.stiffness.shape[0] * time.stride)
    chunk = min(chunk, time.samples // LEAST_CHUNKS)
    parts = steps.state, steps.samples, monitor
    try:
        run_in_chunks(time.samples, chunk, march, parts, progress, None, keeper)
    except StoppedError as error:
        error.result = result(error.samples)
        raise
    return result(time.samples)


def check(
    scene: RockMass,
    steps: Leapfrog,
    monitor: Guard,
    time: Clock,
    critical: float,
    first: int,
    last: int,
) -> None:
    """Raise StoppedError where a run leaves its bounds in samples first .. last - 1."""
    if scene.record.energy:
        audit(monitor, steps.samples.energy, first, last, time.stride)
    speed = np.abs(steps.v).reshape(-1, steps.problem.body.components).max(axis=1)
    look(monitor, speed.max(initial=0.0), last * time.stride)
    step, what, sound = monitor.found.tolist()
    if step < 0:
        return
    fastest = int(np.nan_to_num(speed, nan=np.inf).argmax())
    place = tuple(steps.problem.body.x[fastest].tolist())
    key = "numerics.continuum.step_fraction"
    seen = Divergence("the continuum", key, step, sound, what == ENERGY, place)
    raise stopped(scene, time, critical, seen)


def quantities(problem: Problem, samples: Samples, count: int) -> dict[str, np.ndarray]:
    """Return what was recorded in the first samples by name, as `rock_mass_dataset` takes it.

    Motion counts from the state at the start. Without joints nothing is known of them.
    """
    dim = problem.body.components

    def vectors(rows: np.ndarray, size: int) -> np.ndarray:
        return rows[:, :count].reshape(-1, size, count).swapaxes(1, 2)

    def since(rows: np.ndarray) -> np.ndarray:
        return vectors(rows - rows[:, :1], dim)

    found = {
        "velocity": vectors(samples.velocity, dim),
        "displacement": since(samples.displacement),
        "stress": vectors(samples.stress, dim * (dim + 1) // 2),
    }
    if len(samples.jump):
        jump = since(samples.jump)
        slip = jump[..., 1] if dim == 2 else jump[..., 1:]
        found |= {"traction": vectors(samples.traction, dim), "gap": jump[..., 0], "slip": slip}
    return found


def versions() -> str:
    """Return the versions of the libraries of a run, as JSON."""
    own = {one.__name__: one.__version__ for one in (np, numba, dolfinx)}
    return json.dumps(own)
