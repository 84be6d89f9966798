"""From a scene to its result by the continuum engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING

import numba
import numpy as np
import xarray as xr

from cases.errors import SceneError
from cases.result import fields
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
from continuum.looks import march_with_looks, runaway_check
from continuum.model import State
from continuum.reach import applies
from continuum.waveforms import energy_terms, waveforms

if TYPE_CHECKING:
    from continuum.snapshots import RockFilm


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
    film = _film(scene, discrete, state, time)
    march_with_looks(
        time,
        state.u.size,
        lambda first, last: run(built, state, samples, time.stride, first, last),
        runaway_check(built, state, time.dt, critical),
        progress,
        film,
    )
    stepped = perf_counter()
    terms, energy = energy_terms(built, samples.energy)
    result = fields(
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
    return xr.Dataset(*(result if film is None else film.developed(result, time)))


def _film(scene: Scene, discrete: Discrete, state: State, time: Clock) -> RockFilm | None:
    """Return what keeps snapshots; None, and nothing imported, where none are asked for."""
    if scene.record.fields is None:
        return None
    from continuum.snapshots import RockFilm

    return RockFilm(scene, discrete, state, time.dt)


def steps_of(scene: Scene, model: str, dim: int | None = None) -> tuple[Clock, float]:
    """Return the clock and the critical step (s) of a scene."""
    return _steps(scene, discretise(scene, model, dim), model)


def _steps(scene: Scene, discrete: Discrete, model: str) -> tuple[Clock, float]:
    numerics = scene.numerics.continuum
    critical = critical_step_of(scene, discrete, model)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "continuum")
    return time, critical
