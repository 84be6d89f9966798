"""Simulation of a rock mass by rigid blocks."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
import xarray as xr

from jointwave.cases.incident import IncidentField
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.bounds import highest_energy, motion_of_contacts
from jointwave.dem.leapfrog import march
from jointwave.dem.model import Samples, State, samples_for, state_at_rest
from jointwave.dem.relaxation import start
from jointwave.dem.system import BlockSystem, prepared
from jointwave.dem.time_loop import Run, followed, refuse_beyond_bounds, versions
from jointwave.dem.waveforms import recorder, waveforms
from jointwave.numerics.divergence import SPEED, Guard, audit, guard
from jointwave.numerics.small_motion import (
    Moved,
    farthest,
    matters,
    overlapping,
    refuse_large_motion,
)
from jointwave.numerics.time_loop import Checkpointer
from jointwave.results.arrays import size_of
from jointwave.results.rock_mass import rock_mass_dataset

MOST_OF_DRIVE = 2_000_000  # numbers: forces on held blocks in memory at a time


def simulate(
    scene: RockMass,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
    incident: IncidentField | None = None,
) -> xr.Dataset:
    """Simulate a rock mass, in the plane or in space."""
    began = perf_counter()
    system = prepared(scene, incident)
    model, time = system.model, system.time
    state, samples = state_at_rest(model), samples_for(model, time.samples)
    rest = start(system, state)
    monitor = guard(highest_energy(system, state))
    built = perf_counter()
    step(system, state, samples, 0, 0)
    snapshots = recorder(system, state)
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        found = rock_mass_dataset(
            scene,
            "dem",
            time.times[:count],
            waveforms(system, samples, count),
            None if samples.energy is None else samples.energy[:, :count],
            model="rigid blocks",
            scheme="leapfrog",
            dt=time.dt,
            critical_dt=system.critical,
            steps=time.steps,
            blocks=system.blocks.cut.count,
            degrees_of_freedom=model.blocks.inertia.size,
            left_over=system.blocks.joints.left_over,
            threads=system.threads,
            bytes=size_of(model, state),
            **({} if rest is None else rest.attributes),
            seconds_setup=built - began,
            seconds_compile=compiled - built,
            seconds_stepping=perf_counter() - compiled,
            versions=versions(),
        )
        return found if snapshots is None else snapshots.add_to(found)

    def march_samples(first: int, last: int) -> None:
        step(system, state, samples, first * time.stride, last * time.stride)
        look(system, state, samples, monitor, first, last)

    def check(first: int, last: int) -> None:
        speeds, places = _energies(system, state), system.blocks.cut.centroid
        refuse_beyond_bounds(scene, time, system.critical, monitor, speeds, places)
        if matters(scene):
            t = last * time.stride * time.dt
            refuse_large_motion(scene, "the rigid blocks", moved_apart(system, state), t, first)

    parts = (state, samples, monitor)
    run = Run(time, system.blocks.cut.count, march_samples, check, parts)
    return followed(run, result, progress, snapshots, keeper)


def moved_apart(system: BlockSystem, state: State) -> Moved | None:
    """Return the contact that has moved furthest over the size of its smaller block, or in the
    plane blocks that overlap without one; None in a single block."""
    blocks, met, dim = system.blocks, system.blocks.contacts, system.blocks.dim
    count = blocks.cut.count
    if dim == 2 and (overlap := overlapping(blocks.partition, state.u[:count])) is not None:
        return overlap
    if not len(met.blocks):
        return None
    moved = motion_of_contacts(system, state)
    reach = np.sqrt(3 * np.trace(met.spread, axis1=1, axis2=2))  # of a rectangle's corners
    ends = reach * np.linalg.norm(moved[:, dim:], axis=1)
    by = np.hypot(np.abs(moved[:, 0]) + ends, np.linalg.norm(moved[:, 1:dim], axis=1))
    volume = np.append(blocks.cut.volume, np.full(len(met.walls), np.inf))
    size = volume[met.blocks].min(axis=1) ** (1 / dim)
    k = farthest(by, size)
    i, j = met.blocks[k].tolist()
    place = tuple(met.centre[k].tolist())
    return Moved(i, j if j < count else -1, float(by[k]), float(size[k]), place)


def step(system: BlockSystem, state: State, samples: Samples, first: int, last: int) -> None:
    """Take the steps first .. last - 1, in batches whose forces fit in memory."""
    model, loads = system.model, system.loads
    width = model.form.stages * loads.onto.shape[1] * len(loads.rows)
    size = max(1, MOST_OF_DRIVE // max(1, width))
    for begin in range(first, max(last, first + 1), size):
        end = min(begin + size, last)
        steps = np.arange(begin, end)
        drive = None if model.held is None else loads.drive(steps)
        shake = None if system.shaking is None else system.shaking(steps)
        march(model, state, samples, system.time.stride, (begin, end), drive, shake, system.threads)


def look(
    system: BlockSystem,
    state: State,
    samples: Samples,
    monitor: Guard,
    first: int,
    last: int,
) -> None:
    """Check the motion after samples first .. last - 1, all of which may be invalid."""
    stride, limit = system.time.stride, monitor.limit.view(np.float64)
    if samples.energy is not None:
        audit(monitor, samples.energy, first, last, stride)
    if monitor.found[0] < 0 and not _energies(system, state).max(initial=0.0) <= limit[0]:
        monitor.found[:] = last * stride, SPEED, first * stride - 1


def _energies(system: BlockSystem, state: State) -> np.ndarray:
    """Return sqrt(m) v of the fastest freedom of each block [N], sqrt(J)."""
    masses = system.blocks.inertia
    return (np.sqrt(masses) * np.abs(state.v[: len(masses)])).max(axis=1)
