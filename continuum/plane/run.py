"""A run of a rock mass before its first step."""

from __future__ import annotations

import numpy as np

from jointwave.cases.incident import IncidentField, free_field
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.prestress import refuse_beyond_strength
from jointwave.cases.run_memory import refuse_beyond_memory, waveform_bytes
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.build import critical_step, rock_operators, weight_of
from jointwave.continuum.model import Ends, Model
from jointwave.continuum.plane.discrete import PlaneDiscrete
from jointwave.continuum.plane.drive import Drive, Entry
from jointwave.continuum.plane.loads import pushes, released
from jointwave.continuum.plane.receivers import receivers
from jointwave.continuum.plane.rock import discretise
from jointwave.continuum.plane.sides import dashpots_on, fixed_sides, points_on, sides_that_are
from jointwave.continuum.scheme import Choice, choose


def discrete_and_steps(scene: RockMass, rock: str, comm) -> tuple[PlaneDiscrete, Choice, float]:
    """Return a rock mass in space, how it is stepped, and the critical step of explicit steps
    (s)."""
    discrete = discretise(scene, rock, comm)
    refuse_beyond_strength(discrete.resolved)
    critical = critical_step(discrete, fixed_sides(scene, discrete.body))
    choice = choose(scene, discrete, critical)
    refuse_beyond_memory(scene, {"record.interval": waveform_bytes(scene)})
    return discrete, choice, critical


def build_model(
    scene: RockMass, discrete: PlaneDiscrete, time: Clock, incident: IncidentField | None = None
) -> Model:
    """Return the constants of a rock mass, for a given clock; incident : of the waves, None: in
    intact rock."""
    body = discrete.body
    mass = body.communicator.total(body.mass)
    quiet = points_on(body, sides_that_are(scene, body, "quiet"))
    fixed = fixed_sides(scene, body, time)
    field = incident or free_field(scene)
    entry = Entry(scene, body, quiet, field) if scene.waves else None
    loads = pushes(scene, body)
    dashpots = dashpots_on(scene, body, quiet, fixed, time.dt, mass)
    steady = [x for x in (weight_of(scene, body), released(scene, body)) if x is not None]
    driven, relaxes = None, mechanisms_of(scene, "jointed")
    if loads or entry is not None:
        driven = Drive(body, time.dt, loads, entry)
    return Model(
        rock=rock_operators(body, mass, time.dt, scene.damping.alpha, relaxes),
        interfaces=discrete.joints,
        ends=Ends(None, None, fixed, dashpots, driven),
        weight=np.sum(steady, axis=0) if steady else None,
        receivers=receivers(scene, discrete),
        dt=time.dt,
    )
