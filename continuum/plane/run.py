"""A run of a rock mass before its first step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.errors import SceneError
from cases.incident import free_field
from cases.material.prestress import refuse_beyond_strength
from continuum.build import critical_step, step_over_mass, weight_of
from continuum.model import Ends, Model, RockOperators
from continuum.plane.drive import Drive, Entry
from continuum.plane.loads import pushes
from continuum.plane.receivers import receivers
from continuum.plane.rock import discretise
from continuum.plane.sides import dashpots_on, fixed_sides, points_on, sides_that_are
from continuum.plane.size import refuse_large_run
from continuum.run import Run
from continuum.scheme import Choice, choose
from continuum.state import empty_samples, state_at_rest

if TYPE_CHECKING:
    from cases.incident import IncidentField
    from cases.sampling import Clock
    from cases.schema.rock_mass import RockMass
    from continuum.plane.rock import PlaneDiscrete


def run_of(scene: RockMass, rock: str, comm=None, incident: IncidentField | None = None) -> Run:
    """Return the run of a rock mass, at rest; incident : of the waves, None: in intact rock.

    Raises SceneError where several processes (comm) were to share it.
    """
    if comm is not None and comm.size > 1:
        allowed = "must be 1: the processes do not share rock masses"
        raise SceneError("mpiexec", "-n", comm.size, allowed)
    discrete, choice, critical = discrete_and_steps(scene, rock)
    model = build_model(scene, discrete, choice.time, incident)
    state = state_at_rest(model, scene.record.energy)
    samples = empty_samples(model, state, choice.time.samples)
    return Run(scene, rock, discrete, model, state, samples, choice, critical)


def discrete_and_steps(scene: RockMass, rock: str) -> tuple[PlaneDiscrete, Choice, float]:
    """Return a rock mass in space, how it is stepped, and the critical step of explicit steps
    (s)."""
    discrete = discretise(scene, rock)
    refuse_beyond_strength(discrete.resolved)
    critical = critical_step(discrete, fixed_sides(scene, discrete.body))
    choice = choose(scene, discrete, critical)
    refuse_large_run(scene, choice.time)
    return discrete, choice, critical


def build_model(
    scene: RockMass, discrete: PlaneDiscrete, time: Clock, incident: IncidentField | None = None
) -> Model:
    """Return the constants of a rock mass, for a given clock."""
    body, alpha = discrete.body, (scene.damping.alpha or 0.0) * time.dt / 2
    quiet = points_on(body, sides_that_are(scene, body, "quiet"))
    fixed = fixed_sides(scene, body, time)
    field = incident or free_field(scene)
    entry = Entry(scene, body, quiet, field) if scene.waves else None
    loads = pushes(scene, body)
    driven = None
    if loads or entry is not None:
        driven = Drive(body, time.dt, loads, entry, np.zeros(body.mass.size))
    return Model(
        rock=RockOperators(
            stiffness=body.stiffness,
            viscosity=body.viscosity,
            mass=body.mass,
            step_over_mass=step_over_mass(body.mass, time.dt, alpha),
            decay=None if scene.damping.alpha is None else (1 - alpha) / (1 + alpha),
        ),
        interfaces=discrete.joints,
        ends=Ends(None, None, fixed, dashpots_on(scene, body, quiet, fixed, time.dt), driven),
        weight=weight_of(scene, body),
        receivers=receivers(scene, discrete),
        dt=time.dt,
    )
