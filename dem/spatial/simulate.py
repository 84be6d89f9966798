"""Simulation of a spatial scene."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.scene import Scene
from jointwave.dem.pillar_snapshots import BlockRecorder
from jointwave.dem.size import refuse_large, refuse_too_many
from jointwave.dem.spatial.build import (
    buffers_for,
    build_model,
    points_with_history,
    samples_for,
    state_at_rest,
)
from jointwave.dem.spatial.ends import contact_points, face_of
from jointwave.dem.spatial.layout import LANES, STRIDE, unpacked
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.model import RowModel, RowState
from jointwave.dem.spatial.record import capturing, ledger_of, waveforms, with_breaks
from jointwave.dem.spatial.stability import critical_spatial_step, highest_speeds
from jointwave.dem.spatial.start import start
from jointwave.dem.static import stiffest
from jointwave.dem.time_loop import Run, followed, refuse_beyond_bounds, thread_count, versions
from jointwave.numerics.divergence import guard, look
from jointwave.numerics.small_motion import Moved, matters, refuse_large_motion
from jointwave.numerics.time_loop import Checkpointer
from jointwave.results.arrays import changed, size_of
from jointwave.results.dataset import dataset

MOST_TURN = 0.045  # rad: small rotations then neglect 1 - cos = 1e-3 of a lever


class Prepared(NamedTuple):
    """A scene ready to run: its numbers, model, clock and critical step (s)."""

    properties: Properties
    model: RowModel
    time: Clock
    critical: float


def prepare(scene: Scene) -> Prepared:
    """Return the model and the clock of a scene; raises SceneError for an unstable step."""
    refuse_too_many(scene)
    p, numerics = calibrate(scene), scene.numerics.dem
    critical = critical_step_of(scene, p)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    refuse_large(scene, time, points=points_with_history(scene, p))
    return Prepared(p, build_model(scene, p, time), time, critical)


def critical_step_of(scene: Scene, p: Properties) -> float:
    """Return the critical step of a scene, s."""
    face, ends = face_of(contact_points(scene)), scene.ends
    turns = scene.motion.rotation != "none"
    return critical_spatial_step(stiffest(scene, p), face, (ends.start, ends.end), turns)


def simulate(
    scene: Scene,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
) -> xr.Dataset:
    """Simulate a scene of motion in space, three or six degrees of freedom per block."""
    began = perf_counter()
    p, model, time, critical = prepare(scene)
    state, samples = state_at_rest(model), samples_for(model, time.samples)
    built = perf_counter()
    threads = thread_count(scene.numerics.dem.threads, p.block_count)
    unheld = guard([np.inf] * model.form.freedoms)
    make_stepper(model, state, buffers_for(model, threads, unheld), samples)(0, 0)
    compiled = perf_counter()
    rest = start(scene, p, model, state)
    held = guard(highest_speeds(scene, p, model, state, time))
    march = make_stepper(model, state, buffers_for(model, threads, held), samples)
    recorder = _recorder(scene, p, model, state, threads, time.dt)
    ready = perf_counter()

    def result(count: int) -> xr.Dataset:
        taken = changed(samples, lambda wave: wave[..., :count])
        found = dataset(
            scene,
            "dem",
            time.times[:count],
            **waveforms(scene, p, taken, time),
            **ledger_of(scene, p, taken),
            model="rigid blocks in space",
            scheme=scene.numerics.dem.scheme,
            dt=time.dt,
            critical_dt=critical,
            steps=time.steps,
            degrees_of_freedom=model.form.freedoms * p.block_count,
            threads=threads,
            bytes=size_of(model, state),
            **({} if rest is None else rest.attributes),
            seconds_setup=built - began + ready - compiled,
            seconds_compile=compiled - built,
            seconds_stepping=perf_counter() - ready,
            versions=versions(),
        )
        found = found if recorder is None else recorder.add_to(found)
        return with_breaks(found, p, model, state) if count == time.samples else found

    def check(first: int, last: int) -> None:
        speed, t = speeds(model, state, p.block_count), last * time.stride * time.dt
        look(held, speed.max(axis=1), last * time.stride)
        refuse_beyond_bounds(scene, time, critical, held, speed[:3].max(axis=0), p.centre_y)
        refuse_large_turns(scene, model, state, t)
        if matters(scene):
            refuse_large_motion(scene, "the rigid blocks", farthest_slip(p, model, state), t, first)

    def march_samples(first: int, last: int) -> None:
        march(first * time.stride, last * time.stride)

    run = Run(time, p.block_count, march_samples, check, (state, samples, held))
    return followed(run, result, progress, recorder, keeper)


def _recorder(
    scene: Scene, p: Properties, model: RowModel, state: RowState, threads: int, dt: float
) -> BlockRecorder | None:
    """Return the recorder of snapshots; None, and nothing imported, without snapshots."""
    if scene.record.fields is None:
        return None
    return BlockRecorder(scene, p, capturing(p, model, state, threads), dt)


def speeds(model: RowModel, state: RowState, blocks: int) -> np.ndarray:
    """Return the magnitude of every component of every block's velocity [freedoms, N]."""
    half = model.form.freedoms
    return np.abs(unpacked(state.motion, STRIDE, blocks)[half : 2 * half])


def farthest_slip(p: Properties, model: RowModel, state: RowState) -> Moved:
    """Return the joint whose faces have slipped furthest at its centre, by small rotations; opening
    leaves faces as large."""
    x, _, z, about_x, _, about_z = unpacked(state.motion, STRIDE, p.block_count)[:6]
    arm = model.block.arm
    slip_x = np.diff(x) + arm * (about_z[1:] + about_z[:-1])
    by = np.hypot(slip_x, np.diff(z) - arm * (about_x[1:] + about_x[:-1]))
    k = int(by.argmax())
    return Moved(k, k + 1, float(by[k]), p.side, (float(p.centre_y[k]),))


def refuse_large_turns(scene: Scene, model: RowModel, state: RowState, t: float) -> None:
    """Raise SceneError if blocks have rotated too far for small rotations at t (s)."""
    if not model.form.turns or model.form.finite:
        return
    rows = state.motion[:, 3 * STRIDE : 6 * STRIDE].reshape(-1, 3, STRIDE)[:, :, :LANES]
    if max(rows.max(), -rows.min()) > MOST_TURN:
        turn = np.abs(rows)
        tile, _, lane = np.unravel_index(turn.argmax(), turn.shape)
        raise SceneError(
            scene.where,
            "motion.rotation",
            scene.motion.rotation,
            f"block {tile * LANES + lane + 1} has turned by {turn.max():.3g} rad at "
            f"t = {t:.4g} s, beyond the {MOST_TURN:g} rad of small rotations: "
            "set motion.rotation = 'finite'",
        )
