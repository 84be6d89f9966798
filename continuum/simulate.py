"""From a scene to its result by the continuum engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
import xarray as xr
from scipy.sparse import csr_matrix

from cases.errors import SceneError, StoppedError
from cases.schema.scene import Scene
from continuum.build import (
    Discrete,
    build_model,
    critical_step_of,
    discretise,
    empty_samples,
    state_at_rest,
)
from continuum.engines import explicit_engine, implicit_engine
from continuum.kinematics import refuse
from continuum.model import Model, Samples, State
from continuum.monitor import Monitor
from continuum.scheme import Choice, choose
from continuum.size import refuse_large_run
from continuum.space import compat
from continuum.validity import applies
from continuum.waveforms import energy_terms, waveforms
from numerics.checkpoint import Keeper
from numerics.time_loop import run_in_stretches
from results.arrays import changed, size_of
from results.dataset import Fields, fields

FREEDOM_STEPS_AT_ONCE = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_STRETCHES = 20  # however short the run

if TYPE_CHECKING:
    from continuum.snapshots import RockFilm


def simulate(
    scene: Scene,
    model: str = "jointed",
    dim: int | None = None,
    progress: Callable[[float], None] | None = None,
    comm=None,
    keeper: Keeper | None = None,
) -> xr.Dataset:
    """Simulate a scene as deformable rock.

    Parameters
    ----------
    model : "jointed" (intact rock, every joint an interface) or "equivalent" (homogenised rock
        mass, soft layers as interfaces of their excess compliance).
    dim : 1, the bar; 2, plane stress; 3, the square column; None leaves it to the scene.
    progress : called with the finished fraction.
    comm : mpi4py's communicator of processes that share the run: all call this alike, each steps
        its part of the rock, and all get the whole result. None: this one alone.
    keeper : keeps checkpoints, `numerics.checkpoint`; each process has its own.

    Raises SceneError for what this model cannot simulate; StoppedError, an UnstableError with the
    result so far, when the motion leaves its bounds or implicit steps do not converge.
    """
    refuse(scene, model, dim)
    reason = applies(scene, model, dim)
    if reason:
        raise SceneError(scene.name or scene.title, "model", model, reason)
    began = perf_counter()
    discrete = discretise(scene, model, dim, comm if comm is not None and comm.size > 1 else None)
    communicator = discrete.body.communicator
    choice, critical = _steps(scene, discrete, model)
    time = choice.time
    refuse_large_run(scene, discrete.kinematics, time)
    built = build_model(scene, discrete, model, time)
    state = state_at_rest(built, scene.record.energy)
    rest = _at_rest(scene, built, state, discrete)
    samples = empty_samples(built, state, time.samples)
    start = explicit_engine if choice.scheme == "explicit" else implicit_engine
    monitor = Monitor(scene, discrete, built, state, samples, choice, critical)
    engine = start(scene, discrete, built, state, samples, monitor)
    film = _film(scene, discrete, state, engine.ahead)
    ready = perf_counter()
    engine.compile()
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        seconds = {
            "seconds_setup": ready - began,
            "seconds_compile": compiled - ready,
            "seconds_stepping": perf_counter() - compiled,
        }
        about = _about(scene, discrete, model, choice, critical) | rest | engine.attributes()
        about |= {"bytes": int(communicator.sum(_bytes(built, state)))}
        for rows in (samples.waves, samples.energy):
            if rows is not None:
                communicator.gather(rows)
        found = _recorded(scene, discrete, built, samples, time.times[:count], about | seconds)
        return xr.Dataset(*(found if film is None else film.developed(found)))

    def march(first: int, last: int) -> None:
        # Every stretch ends with the step of a sample: what follows it belongs to the next one.
        engine.march(max(0, (first - 1) * time.stride + 1), (last - 1) * time.stride + 1)
        monitor.check(first, last)
        if film is not None:
            film.look(last - 1)

    parts = state, samples, monitor.parts, engine.parts
    work = engine.work * int(communicator.largest(state.u.size)) * time.stride
    chunk = min(FREEDOM_STEPS_AT_ONCE // work, time.samples // LEAST_STRETCHES)
    try:
        run_in_stretches(time.samples, chunk, march, parts, progress, film, keeper, 1)
    except StoppedError as error:
        error.result = result(error.samples)
        raise
    return result(time.samples)


def steps_of(scene: Scene, model: str, dim: int | None = None) -> tuple[Choice, float]:
    """Return how a scene is stepped, and the critical step of explicit steps (s)."""
    return _steps(scene, discretise(scene, model, dim), model)


def _steps(scene: Scene, discrete: Discrete, model: str) -> tuple[Choice, float]:
    critical = critical_step_of(scene, discrete, model)
    return choose(scene, discrete, critical), critical


def _recorded(
    scene: Scene,
    discrete: Discrete,
    built: Model,
    samples: Samples,
    times: np.ndarray,
    about: dict[str, Any],
) -> Fields:
    """Return what was recorded at these times as a result, with attributes about the run."""
    until = changed(samples, lambda rows: rows[:, : times.size])
    terms, energy = energy_terms(built, until.energy, discrete.body.communicator)
    return fields(
        scene,
        f"continuum-{about['model']}",
        times,
        **waveforms(scene, discrete, until),
        energy=energy,
        terms=terms,
        **about,
    )


def _about(
    scene: Scene, discrete: Discrete, model: str, choice: Choice, critical: float
) -> dict[str, Any]:
    """Return what a result says of its run."""
    versions = {"numpy": np.__version__, "numba": numba.__version__, "basix": compat.VERSION}
    return {
        "model": model,
        "scheme": choice.scheme,
        "scheme_reason": choice.reason,
        "dim": discrete.kinematics.dim,
        "cell": discrete.body.mesh.cell,
        "order": scene.numerics.continuum.order,
        "dt": choice.time.dt,
        "critical_dt": critical,
        "steps": choice.time.steps,
        "degrees_of_freedom": discrete.body.degrees_of_freedom,
        "processes": discrete.body.communicator.size,
        "versions": json.dumps(versions),
    }


def _bytes(built: Model, state: State) -> int:
    """Return the bytes that model and state take."""
    jump = () if built.interfaces is None else (built.interfaces.jump,)
    sparse = [m for m in (*jump, *built.receivers) if isinstance(m, csr_matrix)]
    return size_of(built, state, [(m.data, m.indices, m.indptr) for m in sparse])


def _at_rest(scene: Scene, built: Model, state: State, discrete: Discrete) -> dict[str, Any]:
    """Bring a scene's rock to rest under gravity, and return what a result says of that."""
    if scene.gravity is None or not scene.gravity.static:
        return {}
    from continuum.implicit.static import settle_static

    return settle_static(scene, built, state, discrete.body).attributes


def _film(scene: Scene, discrete: Discrete, state: State, ahead: float) -> RockFilm | None:
    """Return what keeps snapshots; None, and nothing imported, where none are asked for."""
    if scene.record.fields is None:
        return None
    from continuum.snapshots import RockFilm

    return RockFilm(scene, discrete, state, ahead)
