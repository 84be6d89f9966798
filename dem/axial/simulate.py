"""From an axial scene to its result."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.loads import with_load_itself
from cases.material.calibrate import calibrate
from cases.sampling import Clock
from cases.schema.scene import Scene
from dem.axial.bound import highest_speed
from dem.axial.model import Model, build
from dem.axial.record import Samples, room, run, terms
from dem.axial.start import start
from dem.axial.state import State
from dem.fragments import break_times, with_fragments
from dem.looks import Run, followed, sighting, versions
from dem.static import since_prestress
from numerics.checkpoint import Keeper
from numerics.divergence import Guard, guard, look
from numerics.instability import stopped
from results.arrays import size_of
from results.dataset import Fields, fields

if TYPE_CHECKING:
    from dem.snapshots import BlockFilm


March = Callable[[int, int], None]
Marcher = Callable[[Scene, Model, State, Samples, Clock, Guard | None], March]


class Scheme(NamedTuple):
    """How the chain is stepped.

    build : of (scene), to the model that is recorded, the state, the clock and the critical step.
    marcher : of (scene, model, state, samples, clock, guard), to what takes samples first ..
        last - 1.
    forces : how often a step computes the force of every joint.
    takes_means : whether the load is its mean over each step.
    """

    build: Callable[[Scene], tuple[Model, State, Clock, float]]
    marcher: Marcher
    forces: int
    takes_means: bool


def _leapfrog(
    scene: Scene, model: Model, state: State, samples: Samples, time: Clock, guard: Guard | None
) -> March:
    def march(first: int, last: int) -> None:
        run(model, state, samples, time.stride, first, last, guard)

    return march


def scheme_of(scene: Scene) -> Scheme:
    """Return how a scene's chain is stepped; a scheme that it does not name is not imported."""
    if scene.numerics.dem.scheme == "leapfrog":
        return Scheme(build, _leapfrog, 1, True)
    from dem.axial import fourth_order
    from dem.axial.composition import KICKS

    return Scheme(fourth_order.build, fourth_order.marcher, len(KICKS), False)


def simulate_fields(
    scene: Scene, progress: Callable[[float], None] | None = None, keeper: Keeper | None = None
) -> Fields:
    """Simulate a scene of axial motion, one freedom a block."""
    began = perf_counter()
    scheme = scheme_of(scene)
    model, state, time, critical = scheme.build(scene)
    rest = start(scene, model, state)
    samples = room(model, state, time.samples)
    held = guard(highest_speed(model, state, time))
    march = scheme.marcher(scene, model, state, samples, time, held)
    built = perf_counter()
    march(0, 0)
    film = _film(scene, model, state, time.stride, time.dt if scheme.takes_means else None)
    compiled = perf_counter()

    def result(count: int) -> Fields:
        stress, times = samples.stress[:, :count], time.times[:count]
        if scheme.takes_means:
            stress = with_load_itself(stress, scene, model.receivers.sections, times, time.dt)
        found = fields(
            scene,
            "dem",
            times,
            stress,
            samples.velocity[:, :count],
            since_prestress(
                scene, calibrate(scene), samples.displacement[:, :count], model.receivers.points
            ),
            None if samples.energy is None else samples.energy[:, :count],
            terms=terms(model),
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
        return _with_breaks(found if film is None else film.developed(found), scene, state, time)

    def check(samples: int) -> None:
        speed = np.abs(state.v)
        look(held, speed.max(), samples * time.stride)
        seen = sighting(held, speed, calibrate(scene).spacing)
        if seen is not None:
            raise stopped(scene, time, critical, seen)

    run = Run(time, state.u.size, march, check, (state, samples, held))
    return followed(run, result, progress, film, keeper)


def _with_breaks(result: Fields, scene: Scene, state: State, time: Clock) -> Fields:
    if state.broke is None or result.coords["time"][1].size < time.samples:
        return result
    times = break_times(state.broke, time.dt, time.steps)
    return with_fragments(result, calibrate(scene), ~np.isnan(times), state.v, times)


def _film(
    scene: Scene, model: Model, state: State, stride: int, mean: float | None
) -> BlockFilm | None:
    """Return what keeps snapshots; None, and nothing imported, where none are asked for.

    mean : s, over which the load is a mean; None where it is not.
    """
    if scene.record.fields is None:
        return None
    from dem.axial.snapshots import shooter
    from dem.snapshots import BlockFilm

    p = calibrate(scene)
    return BlockFilm(scene, p, shooter(p, model, state, stride), mean)
