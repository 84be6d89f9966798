"""Simulation of an axial scene."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.loads import with_load_itself
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import Clock, interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial import fourth_order, leapfrog
from jointwave.dem.axial.build import build
from jointwave.dem.axial.model import Model, Receivers
from jointwave.dem.axial.samples import buffers, terms
from jointwave.dem.axial.stability import highest_speed
from jointwave.dem.axial.start import start
from jointwave.dem.axial.state import State
from jointwave.dem.fragments import with_fragments
from jointwave.dem.pillar_snapshots import BlockFrame, BlockRecorder
from jointwave.dem.static import since_prestress
from jointwave.dem.time_loop import Run, followed, refuse_beyond_bounds, versions
from jointwave.numerics.divergence import guard, look
from jointwave.numerics.time_loop import Checkpointer
from jointwave.results.arrays import copied, size_of
from jointwave.results.dataset import dataset

#: Of (model, state, samples, stride, monitor): a function that takes samples first .. last - 1.
MakeStepper = Callable[..., Callable[[int, int], None]]


class Scheme(NamedTuple):
    """How the chain is stepped.

    build : of (scene), to the model, the state, the clock and the critical step.
    make_stepper : of (scene, clock), to what takes samples.
    forces : how often a step computes the force of every joint.
    takes_means : whether the load is its mean over each step.
    """

    build: Callable[[Scene], tuple[Model, State, Clock, float]]
    make_stepper: Callable[[Scene, Clock], MakeStepper]
    forces: int
    takes_means: bool


def scheme_of(scene: Scene) -> Scheme:
    """Return how a scene's chain is stepped; a scheme that it does not name is not imported."""
    if scene.numerics.dem.scheme == "leapfrog":
        return Scheme(build, lambda scene, time: leapfrog.make_stepper, 1, True)

    def make_stepper(scene: Scene, time: Clock) -> MakeStepper:
        return partial(fourth_order.make_stepper, fourth_order.compose(scene, time))

    return Scheme(fourth_order.build, make_stepper, len(fourth_order.KICKS), False)


def simulate(
    scene: Scene,
    progress: Callable[[float], None] | None = None,
    keeper: Checkpointer | None = None,
) -> xr.Dataset:
    """Simulate a scene of axial motion, one degree of freedom per block."""
    began = perf_counter()
    scheme = scheme_of(scene)
    model, state, time, critical = scheme.build(scene)
    model, rest = start(scene, model, state)
    samples = buffers(model, state, time.samples)
    monitor = guard(highest_speed(model, state, time))
    make_stepper = scheme.make_stepper(scene, time)
    march = make_stepper(model, state, samples, time.stride, monitor)
    built = perf_counter()
    march(0, 0)
    mean = time.dt if scheme.takes_means else None
    recorder = _recorder(scene, make_stepper, model, state, time.stride, mean)
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        stress, times = samples.stress[:, :count], time.times[:count]
        if scheme.takes_means:
            stress = with_load_itself(stress, scene, model.receivers.sections, times, time.dt)
        found = dataset(
            scene,
            "dem",
            times,
            stress,
            samples.velocity[:, :count],
            since_prestress(
                scene, calibrate(scene), samples.displacement[:, :count], model.receivers.points
            ),
            None if samples.energy is None else samples.energy[:, :count],
            terms=terms(model.effects),
            model="rigid blocks",
            scheme=scene.numerics.dem.scheme,
            dt=time.dt,
            critical_dt=critical,
            steps=time.steps,
            force_evaluations=scheme.forces * time.steps,
            degrees_of_freedom=state.u.size,
            threads=1,
            bytes=size_of(model, state),
            **({} if rest is None else rest.attributes),
            seconds_setup=built - began,
            seconds_compile=compiled - built,
            seconds_stepping=perf_counter() - compiled,
            versions=versions(),
        )
        return _with_breaks(
            found if recorder is None else recorder.add_to(found), scene, state, time
        )

    def check(first: int, last: int) -> None:
        speed = np.abs(state.v)
        look(monitor, speed.max(), last * time.stride)
        centres = calibrate(scene).centre_y
        refuse_beyond_bounds(scene, time, critical, monitor, speed, centres)

    whole = Run(time, state.u.size, march, check, (state, samples, monitor))
    return followed(whole, result, progress, recorder, keeper)


def _with_breaks(result: xr.Dataset, scene: Scene, state: State, time: Clock) -> xr.Dataset:
    if state.broke is None or result.sizes["time"] < time.samples:
        return result
    broke = state.broke
    times = np.where((broke >= 0) & (broke <= time.steps), time.dt * broke, np.nan)
    return with_fragments(result, calibrate(scene), ~np.isnan(times), state.v, times)


def _recorder(
    scene: Scene,
    make_stepper: MakeStepper,
    model: Model,
    state: State,
    stride: int,
    mean: float | None,
) -> BlockRecorder | None:
    """Return the recorder of snapshots; None, and nothing imported, without snapshots.

    mean : s, over which the load is a mean; None where it is not.
    """
    if scene.record.fields is None:
        return None
    p = calibrate(scene)
    everywhere = model._replace(receivers=_everywhere(p))

    def capture(sample: int) -> BlockFrame:
        """Take a sample of all contacts and blocks, with the step that it needs, on a copy."""
        now, twin = sample * stride, copied(state)
        found = buffers(everywhere, twin, 1)
        shifted = everywhere._replace(load=model.load[now:], base=model.base[now:])
        make_stepper(shifted, twin, found, 1)(0, 1)
        return BlockFrame(found.stress[:, 0], found.displacement, found.velocity)

    return BlockRecorder(scene, p, capture, mean)


def _everywhere(p: Properties) -> Receivers:
    contacts, centres = p.contact_y, p.centre_y
    return Receivers(
        interpolation(contacts, contacts.tolist()), interpolation(centres, centres.tolist())
    )
