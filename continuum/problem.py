"""From a scene to a `Problem`: a body with its joint law, loads, boundaries and receivers."""

from typing import Any

import numpy as np

from jointwave.cases.geometry.periodic import of_all
from jointwave.cases.incident import IncidentField
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.closure import closed_compliance
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.properties import strength_of
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.joints import resolved_joints
from jointwave.continuum.loads.forces import Loads, pushes, released, waves_of, weight_of
from jointwave.continuum.loads.sides import bearing_sides, held_sides, quiet_sides
from jointwave.continuum.receivers.points import readings_of
from jointwave.continuum.receivers.sections import readings_of_pillar
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space.model import Body, directions
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.static import Rest, elastic_rest, holding, settled
from jointwave.joints.law import Law, law, stiffest, uniform

MOST = 0.01  # most of a joint's compliance that stays when it is closed


def with_law(found: SceneBody) -> tuple[Body, Law | None]:
    """Return a body and the law of its joints (None without), with a column for each contact of a
    rock mass or each resolved joint of a pillar."""
    scene, body, joints = found.scene, found.body, found.body.joints
    if not len(joints.weight):
        return body, None
    if scene.is_column:
        p, shears = calibrate(scene), body.components > 1
        loses = not (found.scripted or scene.mesh_path)
        resolved = resolved_joints(scene, found.model, shears, loses)
        which, column = np.unique(joints.column, return_inverse=True)
        body = body._replace(joints=joints._replace(column=column.reshape(-1)))
        normal, shear = resolved.stiffness, resolved.shear_stiffness if shears else None
        etas, tension, strengths = resolved.time_constant, p.tension, p.strengths(shears, which)
        less, lag = resolved.less[which], p.ordinary_time_constant[which]
    else:
        sets, which = scene.joint_sets, of_all(found.blocks, found.across, "joint_set")
        which = np.clip(which, 0, len(sets) - 1)  # any law: cuts through rock are no joints
        stiffness = [[one.normal_stiffness, one.shear_stiffness] for one in sets]
        normal, shear = np.array(stiffness, dtype=float).T
        etas, tension = set_time_constants(scene), np.array([i.tension is not False for i in sets])
        strengths, (less, lag) = strength_of(sets, which).strengths(), np.zeros((2, len(which)))
    etas, shear = (None if one is None else one[which] for one in (etas, shear))
    own = law(normal[which], etas, tension[which], shear_stiffness=shear, **strengths)
    if own.maximum_closure is not None:
        rock = np.minimum(closed_compliance(scene), MOST / normal[which]) - less
        lag = np.divide(-less * lag, rock, out=np.zeros(len(which)), where=rock != 0)
        own = own._replace(rock_compliance=uniform(rock), rock_time_constant=uniform(lag))
    return body, own


def problem_of(scene: AnyScene, found: SceneBody) -> Problem:
    """Return a scene as a problem, without loads that have a history.

    Masses, forces and energies of a pillar in one or two dimensions are per unit area or thickness;
    `scene.left_out` gives the factor.
    """
    (body, own), stress, other = with_law(found), None, None
    steady = [one for one in (weight_of(scene, body), released(scene, body)) if one is not None]
    if scene.prestress is not None:
        stress = scene.prestress.tensor[np.ix_(directions(body), directions(body))]
    relaxes = mechanisms_of(scene, found.model)
    if found.scripted:  # at its reference frequency
        share = 1.0 if relaxes is None else relaxes.unrelaxed
        other = [(one.stiffness / share, one.density) for one in found.materials], found.of_cell
    read: Any = readings_of_pillar if scene.is_column else readings_of
    return Problem(
        body,
        read(scene, found, stress),
        law=own,
        stiffest=None if own is None else stiffest(own, scene),
        stress=stress,
        alpha=scene.damping.alpha or 0.0,
        mechanisms=relaxes,
        steady=np.sum(steady, axis=0) if steady else None,
        quiet=quiet_sides(found.scene if other else scene, body, found.model, other),
        held=held_sides(scene, body),
    )


def in_time(
    scene: AnyScene, problem: Problem, time: Clock, incident: IncidentField | None, model: str
) -> Problem:
    """Return a problem with the forces and base motion of a scene, for the steps of a clock;
    incident : field of the waves; absent: that in unjointed rock."""
    body, forces = problem.body, None
    pushed, waves = pushes(scene, body, model), waves_of(scene, body, incident)
    if pushed or waves is not None:
        forces = Loads(body.mass.size, time.dt, pushed, waves)
    return problem._replace(forces=forces, held=held_sides(scene, body, time))


def at_rest(scene: AnyScene, problem: Problem) -> tuple[Problem, Rest | None, np.ndarray | None]:
    """Return the problem with the reactions of sides that bear its weight; the static state under
    gravity or after excavation, or None; and the forces (N) that begin to act at t = 0, sudden
    gravity and its reactions, or None."""
    gravity, body = scene.gravity, problem.body
    static, weight = gravity is not None and gravity.static, weight_of(scene, body)
    if weight is None and not scene.excavated:
        return problem, None, None
    hold = holding(problem, bearing_sides(scene, body))
    before, rest = problem, None
    if weight is not None and not static:  # the weight acts from t = 0 on
        before = problem._replace(steady=problem.steady - weight)
    if static or scene.excavated:
        rest = settled(scene, before, hold if static else None)
    if weight is not None and hold is not None:
        held = rest.u if static and rest is not None else elastic_rest(before, weight, hold)
        borne = hold @ held
        problem, weight = problem._replace(steady=problem.steady - borne), weight - borne
    return problem, rest, None if static else weight
