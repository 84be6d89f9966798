"""Simulation as deformable rock, from a scene to its result."""

import json
import logging
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numba
import numpy as np
import xarray as xr

from jointwave.cases.incident import IncidentField
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.monitor import Monitor
from jointwave.continuum.plan import Choice, Plan, plan_of
from jointwave.continuum.problem import at_rest, in_time
from jointwave.continuum.processes.leapfrog import SharedLeapfrog
from jointwave.continuum.receivers.snapshots import RockRecorder
from jointwave.continuum.receivers.waveforms import recorded
from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.continuum.space.rock import Rock
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.static import Rest
from jointwave.numerics.time_loop import Checkpointer, run_in_chunks
from jointwave.results.dataset import energy_residual

FREEDOM_STEPS_AT_ONCE = 10_000_000  # in some 0.1 s: often enough for a progress bar
LEAST_CHUNKS = 20  # of any run
COARSE = 0.1  # imbalance of implicit steps from which to warn
FINER = "double numerics.continuum.steps_per_period, or take explicit steps"
log = logging.getLogger("jointwave")


def simulate(
    scene: AnyScene,
    model: str = "jointed",
    rock: Rock | None = None,
    dim: int | None = None,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
    incident: IncidentField | None = None,
    comm: Any = None,
) -> xr.Dataset:
    """Simulate a scene as deformable rock.

    Parameters
    ----------
    model : "jointed", every joint an interface, or "equivalent", with the joints of a pillar, or
        joint sets with a spacing, in an effective medium.
    rock : function of the scene and a dolfinx space that returns the rock as UFL forms, instead of
        the scene's rock; with unrelaxed moduli where the scene has a quality factor. Waves,
        compliant bases and absorbing ends of a pillar need the scene's rock and are refused then.
    dim : of a pillar's mesh: 1, the bar; 2, plane stress; 3, the square column; absent: as in the
        scene.
    progress : called with the finished fraction.
    keeper : saves checkpoints, `numerics.time_loop.Checkpointer`.
    incident : field of the waves in unbounded rock; absent: that in unjointed rock, with a warning
        where the scene has joints; `jointwave.simulate` takes the one that belongs to the scene.
    comm : mpi4py communicator of the processes that share the run; the call is collective, and all
        processes get the whole result. keeper, progress : of each process.

    Raises SceneError for a scene that cannot be simulated; StoppedError, with the result so far,
    when the motion leaves its bounds.
    """
    began, comm = perf_counter(), comm if comm is not None and comm.size > 1 else None
    plan = plan_of(scene, model, rock, dim, comm)
    time = plan.choice.time
    problem, rest, sudden = at_rest(scene, in_time(scene, plan.problem, time, incident, model))
    steps = stepper(scene, problem, plan.choice, rest, sudden)
    monitor = Monitor(plan, steps, None if rest is None else rest.u)
    recorder = None if scene.record.fields is None else RockRecorder(scene, plan.found, steps)
    built = perf_counter()
    steps.take(0, 0, time.stride)
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        about = {
            "model": model,
            **about_run(scene, plan, steps, rest),
            "seconds_setup": built - began,
            "seconds_compile": compiled - built,
            "seconds_stepping": perf_counter() - compiled,
        }
        dataset = recorded(scene, problem, steps.samples, time.times[:count], about)
        return dataset if recorder is None else recorder.add_to(dataset)

    def march(first: int, last: int) -> None:
        done = first * time.stride
        if recorder is not None:
            steps.take(done, done + 1, time.stride)
            recorder.record_if_due(first)
            done += 1
        steps.take(done, last * time.stride, time.stride)
        monitor.check(first, last)

    work = steps.work_of_a_step * problem.body.mass.size * time.stride
    chunk = min(FREEDOM_STEPS_AT_ONCE // work, time.samples // LEAST_CHUNKS)
    parts = steps.parts, steps.samples, monitor.guard
    found = run_in_chunks(time.samples, chunk, march, result, parts, progress, recorder, keeper)
    off = energy_residual(found) if scene.record.energy else 0.0
    if plan.choice.scheme == "implicit" and off > COARSE:
        log.warning(f"{scene.where}: energies are {off:.2g} of the work off: {FINER}")
    return found


def about_run(
    scene: AnyScene, plan: Plan, steps: Leapfrog | Implicit, rest: Rest | None
) -> dict[str, Any]:
    """Return the attributes of a result about its run; collective over processes."""
    (_, _, choice, critical), body, comm = plan, steps.problem.body, steps.problem.comm
    about = {
        "scheme": choice.scheme,
        "scheme_reason": choice.reason,
        "dim": body.x.shape[1],
        "cell": body.cell.kind,
        "order": scene.numerics.continuum.order,
        "dt": choice.time.dt,
        "critical_dt": critical,
        "steps": choice.time.steps,
        "degrees_of_freedom": body.mass.size,
        "bytes": steps.bytes if comm is None else comm.allreduce(steps.bytes),
        "processes": 1 if comm is None else comm.size,
        "versions": json.dumps({one.__name__: one.__version__ for one in (np, numba, dolfinx)}),
    }
    if rest is not None:
        about |= {"static_steps": rest.steps, "static_out_of_balance": rest.ratio}
    return about | steps.attributes


def stepper(
    scene: AnyScene, problem: Problem, choice: Choice, rest: Rest | None, sudden: np.ndarray | None
) -> Leapfrog | Implicit:
    """Return the time stepper of a run, at its static state if there is one; sudden : forces (N)
    that begin to act at t = 0."""
    given = problem, choice.time.dt, choice.time.samples
    steps: Leapfrog | Implicit
    if choice.scheme == "explicit":
        of = Leapfrog if problem.comm is None else SharedLeapfrog
        steps = of(*given, scene.record.energy)
        if sudden is not None:
            steps.drop(sudden)
    else:
        rho = scene.numerics.continuum.spectral_radius
        steps = Implicit(*given, rho, scene.record.energy)
    if rest is not None:
        steps.start(rest.u, rest.history)
    return steps
