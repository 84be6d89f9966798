"""Simulation by rigid blocks, from a scene to its result."""

import json
from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numba
import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.damping import NOT_OF_BLOCKS
from jointwave.dem.bounds import highest_energy, moved_apart, refuse_large_rotation
from jointwave.dem.kernel.leapfrog import make_stepper
from jointwave.dem.kernel.model import Samples, State, first_of, samples_for, state_at_rest
from jointwave.dem.kernel.parts import thread_count
from jointwave.dem.kernel.rotation import columns_less_one
from jointwave.dem.prepare import blocks_of, clock_of, prepared
from jointwave.dem.readings.snapshots import recorder
from jointwave.dem.relaxation import start
from jointwave.dem.system import BlockSystem
from jointwave.numerics.divergence import Guard, Guarded, check, guard
from jointwave.numerics.small_motion import refuse_large_motion
from jointwave.numerics.time_loop import Checkpointer, run_in_chunks
from jointwave.results.arrays import size_of

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField

BLOCK_STEPS_AT_ONCE = 20_000_000  # in some 10 ms to 1 s: often enough for a progress bar
LOOKS = 20  # checks of a run, at least: blocks may move too far
LEAST_STEPS = 64  # at a time: each thread copies its blocks before and after
MOST_OF_DRIVE = 2_000_000  # force components on held blocks in memory at a time
TURNED_FOR = 64  # most steps between updates of a load's arm: a few vibrations of a block


def simulate(
    scene: AnyScene,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
    incident: "IncidentField | None" = None,
) -> xr.Dataset:
    """Simulate a scene with rigid blocks.

    progress : called with the finished fraction. keeper : saves checkpoints. incident : field that
    enters a rock mass through quiet sides; absent: the scene's waves in unjointed rock.

    Raises SceneError for an unstable step, a missing static state, rotations too large for small
    kinematics, a quality factor; StoppedError, an UnstableError with the result so far, when the
    motion leaves its bounds.
    """
    if (quality := scene.rock.quality_factor) is not None:
        raise SceneError(scene.where, "rock.quality_factor", quality, NOT_OF_BLOCKS)
    began = perf_counter()
    system = prepared(scene, incident)
    model, time = system.model, system.time
    state, samples = state_at_rest(model), samples_for(model, time.samples)
    rest = start(system, state)
    monitor = guard(highest_energy(system, state))
    built = perf_counter()
    step = stepper(system, state, samples)
    step(0, 0)
    snapshots = recorder(system, state)
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        found = system.blocks.receivers.dataset(
            system,
            state,
            first_of(samples, count),
            model="rigid blocks",
            dt=time.dt,
            critical_dt=system.blocks.critical,
            steps=time.steps,
            blocks=system.blocks.count,
            degrees_of_freedom=model.blocks.inertia.size,
            threads=system.threads,
            bytes=size_of(model, state),
            **({} if rest is None else rest.attributes),
            seconds_setup=built - began,
            seconds_compile=compiled - built,
            seconds_stepping=perf_counter() - compiled,
            versions=json.dumps({"numpy": np.__version__, "numba": numba.__version__}),
        )
        return found if snapshots is None else snapshots.add_to(found)

    def march(first: int, last: int) -> None:
        if snapshots is not None:
            snapshots.record_if_due(first)
        step(first * time.stride, last * time.stride)
        look(system, state, samples, monitor, first, last)
        t = last * time.stride * time.dt
        refuse_large_rotation(system, state, t)
        moved = partial(moved_apart, system, state)
        refuse_large_motion(scene, "the rigid blocks", moved, t, first)

    steps = min(BLOCK_STEPS_AT_ONCE // system.blocks.count, time.steps // LOOKS)
    chunk, parts = max(LEAST_STEPS, steps) // time.stride, (state, samples, monitor)
    return run_in_chunks(time.samples, chunk, march, result, parts, progress, snapshots, keeper)


class Plan(NamedTuple):
    """Size of a run: its clock, critical step (s), degrees of freedom and threads."""

    time: Clock
    critical: float
    freedoms: int
    threads: int


def plan(scene: AnyScene) -> Plan:
    """Return the size of a run; raises the SceneErrors of its preparation."""
    blocks = blocks_of(scene)
    time = clock_of(blocks)
    threads = thread_count(scene.numerics.dem.threads, blocks.count, blocks.dim)
    return Plan(time, blocks.critical, blocks.inertia.size, threads)


def stepper(system: BlockSystem, state: State, samples: Samples) -> Callable[[int, int], None]:
    """Return a function that takes the steps first .. last - 1, in batches whose forces fit in
    memory; without steps (first == last) it compiles the kernel."""
    model, loads, time, stages = system.model, system.loads, system.time, system.model.form.stages
    width = stages * loads.onto.shape[1] * len(loads.rows)
    size = min(max(1, MOST_OF_DRIVE // max(1, width)), time.stride * time.samples)
    drive, shake, shaking = None, None, system.shaking
    turns = model.held is not None and model.form.finite and system.blocks.scene.load.arm is None
    if turns:
        size = min(size, TURNED_FOR)
    if model.held is not None:
        drive = np.zeros((stages * size, len(loads.rows), model.form.freedoms))
    if shaking is not None:
        shake = np.zeros((size, model.walls, model.form.dim))
    take = make_stepper(model, state, samples, size, drive, shake, system.threads)

    def advance(first: int, last: int) -> None:
        # Arms turn at each sample and so many steps after it: the same in any chunks, bit for bit.
        every = time.stride if turns else max(last - first, 1)
        pieces = [
            (at + k, at + every)
            for at in range(first, max(last, first + 1), every)
            for k in range(0, every, size)
        ]
        for begin, end in pieces:
            steps = np.arange(begin, min(begin + size, end, last))
            if drive is not None:
                drive[: stages * len(steps)] = loads.drive(steps)
            if drive is not None and turns:
                q = state.turn[loads.rows], *state.u[loads.rows, 3:].T
                drive[: len(steps), :, 3:] += loads.turned(steps, np.array(columns_less_one(q)).T)
            if shake is not None and shaking is not None:
                shake[: len(steps)] = shaking(steps)
            take(time.stride, begin, begin + len(steps))

    return advance


def look(
    system: BlockSystem, state: State, samples: Samples, monitor: Guard, first: int, last: int
) -> None:
    """Check the motion in samples first .. last - 1, and its energy where the ledger is exact.

    Raises StoppedError, with the block of the most energy, if the motion leaves its bounds.
    """
    blocks, form = system.blocks, system.model.form
    masses, momenta = blocks.inertia, system.model.inertia
    if form.finite:
        masses = np.hstack([masses[:, :3], np.full_like(masses[:, 3:], masses[:, 3:].max())])
    fastest = (momenta / np.sqrt(masses) * np.abs(state.v[: len(masses)])).max(axis=1)  # sqrt(J)
    key = "numerics.dem.step_fraction"
    run = Guarded(blocks.scene, "the rigid blocks", key, system.time, blocks.critical)
    energy = samples.energy if form.stages == 1 else None
    check(monitor, run, (first, last), energy, fastest, blocks.centroid)
