"""From a scene to a body and what acts on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jointwave.cases.incident import IncidentField
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.material.strength import strength_of
from jointwave.cases.partition.periodic import of_all
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.loads.ends import bearing_ends
from jointwave.continuum.loads.forces import loads_of, released, weight_of
from jointwave.continuum.loads.sides import (
    bearing_sides,
    cells_behind,
    held_sides,
    quiet_sides,
)
from jointwave.continuum.pillar import in_time as pillar_in_time
from jointwave.continuum.pillar import problem_of as pillar_problem
from jointwave.continuum.receivers.points import readings_of
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space.model import Facets
from jointwave.continuum.space.own_rock import impedances_along
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.static import Rest, elastic_rest, holding, settled
from jointwave.joints.law import Law, law, stiffest


def law_of(found: SceneBody) -> Law | None:
    """Return the law of a rock mass's joints, a column for each contact; None without joints."""
    scene = found.scene
    assert not scene.is_column
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


def problem_of(scene: AnyScene, found: SceneBody) -> Problem:
    """Return the body of a scene and what acts on it all the time."""
    if scene.is_column:
        return pillar_problem(scene, found)
    body, own = found.body, law_of(found)
    stress = None if scene.prestress is None else scene.prestress.tensor
    moduli, lag = (
        np.array([getattr(one, name) for one in found.materials])[found.of_cell]
        for name in ("stiffness", "time_constant")
    )
    points, joints = (
        np.array(places, dtype=float).reshape(-1, body.components)
        for places in (scene.record.points, scene.record.joints)
    )
    steady = [one for one in (weight_of(scene, body), released(scene, body)) if one is not None]
    return Problem(
        body,
        readings_of(body, moduli, points, joints, stress, lag),
        law=own,
        stiffest=None if own is None else stiffest(own, scene),
        stress=stress,
        alpha=scene.damping.alpha or 0.0,
        mechanisms=mechanisms_of(scene, found.model),
        steady=np.sum(steady, axis=0) if steady else None,
        quiet=quiet_sides(scene, body, own_impedances(found)),
        held=held_sides(scene, body),
    )


def own_impedances(found: SceneBody) -> Callable[[Facets], np.ndarray] | None:
    """Return the function that gives the impedances of facets, tensors [n, d, d], Pa s/m, of rock
    of a script; None of the scene's own."""
    if not found.scripted:
        return None

    def impedances(facets: Facets) -> np.ndarray:
        which = found.of_cell[cells_behind(found.body, facets)]
        return impedances_along([found.materials[k] for k in which], facets.normal)

    return impedances


def in_time(
    scene: AnyScene, problem: Problem, time: Clock, incident: IncidentField | None
) -> Problem:
    """Return a problem with forces and motion that have a history, for the steps of a clock;
    incident : of the waves, in intact rock where absent."""
    if scene.is_column:
        return pillar_in_time(scene, problem, time)
    forces = loads_of(scene, problem.body, time.dt, incident)
    return problem._replace(forces=forces, held=held_sides(scene, problem.body, time))


def at_rest(scene: AnyScene, problem: Problem) -> tuple[Problem, Rest | None, np.ndarray | None]:
    """Return a problem on sides that bear its weight; the state at rest under gravity and around
    what is excavated, None where it starts unstrained; and the forces (N) that begin to act at
    t = 0, the weight and what bears it, None without."""
    gravity, body = scene.gravity, problem.body
    static, weight = gravity is not None and gravity.static, weight_of(scene, body)
    if weight is None and not scene.excavated:
        return problem, None, None
    bears = bearing_ends(scene, body) if scene.is_column else bearing_sides(scene, body)
    hold = holding(problem, bears)
    before, rest = problem, None
    if weight is not None and not static:  # it acts later
        before = problem._replace(steady=problem.steady - weight)
    if static or scene.excavated:
        rest = settled(scene, before, hold if static else None)
    if weight is not None and hold is not None:
        held = rest.u if static and rest is not None else elastic_rest(before, weight, hold)
        borne = hold @ held
        problem, weight = problem._replace(steady=problem.steady - borne), weight - borne
    return problem, rest, None if static else weight
