"""From a scene to its result by the continuum engine."""

from __future__ import annotations

import json
from collections.abc import Callable
from time import perf_counter
from typing import Any, NamedTuple

import numba
import numpy as np
import xarray as xr
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError, StoppedError
from jointwave.cases.incident import IncidentField
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import weight_of
from jointwave.continuum.ends import borne_ends
from jointwave.continuum.engines import Engine, explicit_engine, implicit_engine
from jointwave.continuum.implicit.static import elastic_rest, holding, settle_static
from jointwave.continuum.model import Model
from jointwave.continuum.monitor import Monitor
from jointwave.continuum.plane.sides import borne_sides
from jointwave.continuum.plane.waveforms import recorded
from jointwave.continuum.run import Run, run_of
from jointwave.continuum.snapshots import RockRecorder
from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.kinematics import refuse
from jointwave.continuum.state import State
from jointwave.continuum.validity import applies
from jointwave.continuum.waveforms import energy_terms, waveforms
from jointwave.numerics.time_loop import Checkpointer, run_in_chunks
from jointwave.results.arrays import changed, size_of
from jointwave.results.dataset import dataset

FREEDOM_STEPS_AT_ONCE = 10_000_000  # some 0.1 s: often enough for a progress bar
LEAST_STRETCHES = 20  # however short the run


def simulate(
    scene: Scene | RockMass,
    model: str = "jointed",
    dim: int | None = None,
    progress: Callable[[float], None] | None = None,
    comm=None,
    keeper: Checkpointer | None = None,
    incident: IncidentField | None = None,
) -> xr.Dataset:
    """Simulate a scene as deformable rock.

    Parameters
    ----------
    model : "jointed" (intact rock, every joint an interface) or "equivalent" (homogenised rock
        mass, soft layers as interfaces of their excess compliance).
    dim : 1, the bar; 2, plane stress; 3, the square column; None leaves it to the scene. A rock
        mass is in plane strain.
    progress : called with the finished fraction.
    comm : mpi4py's communicator of processes that share the run: all call this alike, each steps
        its part of the rock, and all get the whole result. None: this one alone.
    keeper : of checkpoints, `numerics.time_loop`; each process has its own.
    incident : of the waves of a rock mass, as if it had no sides; None: in rock without joints.

    Raises SceneError for what this model cannot simulate; StoppedError, an UnstableError with the
    result so far, when the motion leaves its bounds or implicit steps do not converge.
    """
    began = perf_counter()
    begun = start(scene, model, dim, comm, incident)
    run, engine = begun.run, begun.engine
    recorder = _recorder(run, engine.ahead)
    ready = perf_counter()
    engine.compile()
    compiled = perf_counter()

    def result(count: int) -> xr.Dataset:
        seconds = {
            "seconds_setup": ready - began,
            "seconds_compile": compiled - ready,
            "seconds_stepping": perf_counter() - compiled,
        }
        about = _about(run) | begun.rest | engine.attributes() | seconds
        found = _recorded(run, run.choice.time.times[:count], about)
        return found if recorder is None else recorder.add_to(found)

    try:
        begun.march(recorder, progress, keeper)
    except StoppedError as error:
        error.result = result(error.samples)
        raise
    return result(run.choice.time.samples)


class Start(NamedTuple):
    """A run at rest before its kernels are compiled; rest : what a result says of its state."""

    run: Run
    monitor: Monitor
    engine: Engine
    rest: dict[str, Any]

    @property
    def parts(self) -> tuple:
        """All arrays that change while the run goes on."""
        return self.run.state, self.run.samples, self.monitor.parts, self.engine.parts

    def march(
        self,
        recorder: RockRecorder | None = None,
        progress: Callable[[float], None] | None = None,
        keeper: Checkpointer | None = None,
    ) -> None:
        """Take all samples and snapshots. Raises StoppedError, without its result."""
        run, time = self.run, self.run.choice.time

        def march(first: int, last: int) -> None:
            # Every stretch ends with the step of a sample: what follows belongs to the next one.
            self.engine.march(max(0, (first - 1) * time.stride + 1), (last - 1) * time.stride + 1)
            self.monitor.check(first, last)
            if recorder is not None:
                recorder.record_if_due(last - 1)

        work = self.engine.work * int(run.communicator.largest(run.state.u.size)) * time.stride
        chunk = min(FREEDOM_STEPS_AT_ONCE // work, time.samples // LEAST_STRETCHES)
        run_in_chunks(time.samples, chunk, march, self.parts, progress, recorder, keeper, 1)


def start(
    scene: Scene | RockMass,
    model: str,
    dim: int | None = None,
    comm=None,
    incident: IncidentField | None = None,
) -> Start:
    """Return the run of a scene at rest; arguments and errors as of `simulate`."""
    refuse(scene, model, dim)
    reason = applies(scene, model, dim)
    if reason:
        raise SceneError(scene.name or scene.title, "model", model, reason)
    run = run_of(scene, model, dim, comm, incident)
    run, rest = _at_rest(run)
    monitor = Monitor(run)
    begin = explicit_engine if run.choice.scheme == "explicit" else implicit_engine
    return Start(run, monitor, begin(run, monitor), rest)


def _recorded(run: Run, times: np.ndarray, about: dict[str, Any]) -> xr.Dataset:
    """Return what was recorded at these times as a result, with attributes about the run."""
    for rows in (run.samples.waves, run.samples.energy):
        if rows is not None:
            run.communicator.gather(rows)
    until = changed(run.samples, lambda rows: rows[:, : times.size])
    if run.scene.kind == "rock mass":
        return recorded(run, until, times, about)
    terms, energy = energy_terms(run.model, until.energy, run.communicator)
    waves = waveforms(run.scene, run.discrete, until)
    name = f"continuum-{run.rock}"
    return dataset(run.scene, name, times, **waves, energy=energy, terms=terms, **about)


def _about(run: Run) -> dict[str, Any]:
    """Return the attributes of a result about its run."""
    versions = {
        "numpy": np.__version__,
        "numba": numba.__version__,
        "basix": basix_versions.VERSION,
    }
    return {
        "model": run.rock,
        "scheme": run.choice.scheme,
        "scheme_reason": run.choice.reason,
        "dim": run.discrete.kinematics.dim,
        "cell": run.discrete.body.mesh.cell,
        "order": run.scene.numerics.continuum.order,
        "dt": run.choice.time.dt,
        "critical_dt": run.critical,
        "steps": run.choice.time.steps,
        "degrees_of_freedom": run.discrete.body.degrees_of_freedom,
        "bytes": int(run.communicator.sum(_bytes(run.model, run.state))),
        "processes": run.communicator.size,
        "versions": json.dumps(versions),
    }


def _bytes(model: Model, state: State) -> int:
    """Return the bytes of model and state."""
    jump = () if model.interfaces is None else (model.interfaces.jump,)
    sparse = [m for m in (*jump, *model.receivers) if isinstance(m, csr_matrix)]
    return size_of(model, state, [(m.data, m.indices, m.indptr) for m in sparse])


def _at_rest(run: Run) -> tuple[Run, dict[str, Any]]:
    """Bring a scene's rock to rest under gravity and around what is excavated, and return it on
    sides that bear its weight, and what a result says of that."""
    gravity, model, body = run.scene.gravity, run.model, run.discrete.body
    static, weight = gravity is not None and gravity.static, weight_of(run.scene, body)
    if weight is None and not run.scene.excavated:
        return run, {}
    rest: dict[str, Any] = {}
    hold = holding(body, _borne(run))
    if weight is not None and not static:  # it acts later
        model = model._replace(weight=model.weight - weight)
    if static or run.scene.excavated:
        rest = settle_static(run.scene, model, run.state, body, hold if static else None)
    if weight is None:
        return run, rest
    if hold is not None:
        u = run.state.u if static else elastic_rest(model, run.state, body, weight, hold)
        borne = -(hold @ u)
        weight += borne
        run = run._replace(model=run.model._replace(weight=run.model.weight + borne))
    return run._replace(sudden=None if static else weight), rest


def _borne(run: Run) -> csr_matrix | None:
    """Return the areas of sides that bear the weight beside their dashpots; None without."""
    if isinstance(run.scene, Scene):
        return borne_ends(run.scene, run.discrete.body)
    return borne_sides(run.scene, run.discrete.body)


def _recorder(run: Run, ahead: float) -> RockRecorder | None:
    """Return the recorder of snapshots; None, and nothing imported, without snapshots."""
    if run.scene.record.fields is None:
        return None
    return RockRecorder(run.scene, run.discrete, run.state, ahead)
