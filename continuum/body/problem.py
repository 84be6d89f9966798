"""From a scene of a rock mass to a body and what acts on it."""

from __future__ import annotations

import numpy as np

from jointwave.cases.incident import IncidentField
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.material.strength import strength_of
from jointwave.cases.partition.periodic import of_all
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.body.loads import loads_of, released, weight_of
from jointwave.continuum.body.receivers import readings_of
from jointwave.continuum.body.scene import SceneBody
from jointwave.continuum.body.sides import held_sides, quiet_sides
from jointwave.continuum.body.steps import Problem
from jointwave.joints.law import Law, law, stiffest


def law_of(found: SceneBody) -> Law | None:
    """Return the law of a rock mass's joints, a column for each contact; None without joints."""
    scene = found.scene
    assert isinstance(scene, RockMass)
    if found.body.joints is None:
        return None
    sets, which = scene.joint_sets, of_all(found.blocks, found.across, "joint_set")
    which = np.clip(which, 0, len(sets) - 1)  # cuts through rock are no joints
    normal, shear = (
        np.array([getattr(one, key) for one in sets], dtype=float)[which]
        for key in ("normal_stiffness", "shear_stiffness")
    )
    etas = set_time_constants(scene)
    own = law(
        normal,
        None if etas is None else etas[which],
        np.array([one.tension is not False for one in sets])[which],
        shear_stiffness=shear,
        **strength_of(sets, which).strengths(),
    )
    return own if own.maximum_closure is None else own._replace(rock_compliance=0.0)


def problem_of(
    scene: RockMass,
    found: SceneBody,
    time: Clock | None = None,
    incident: IncidentField | None = None,
) -> Problem:
    """Return what acts on the body of a rock mass; time : of its steps, without which no force or
    motion has a history. incident : of the waves, in intact rock where absent."""
    body, own = found.body, law_of(found)
    stress = None if scene.prestress is None else scene.prestress.tensor
    region = found.blocks.body.region[body.block]
    moduli = np.array([one.stiffness for one in found.materials])[region]
    dim = body.components
    readings = readings_of(
        body,
        moduli,
        np.array(scene.record.points, dtype=float).reshape(-1, dim),
        np.array(scene.record.joints, dtype=float).reshape(-1, dim),
        stress,
        found.materials[-1].time_constant,
    )
    steady = [one for one in (weight_of(scene, body), released(scene, body)) if one is not None]
    return Problem(
        body,
        readings,
        law=own,
        stiffest=None if own is None else stiffest(own, scene),
        stress=stress,
        alpha=scene.damping.alpha or 0.0,
        steady=np.sum(steady, axis=0) if steady else None,
        quiet=quiet_sides(scene, body),
        forces=None if time is None else loads_of(scene, body, time.dt, incident),
        held=held_sides(scene, body, time),
    )
