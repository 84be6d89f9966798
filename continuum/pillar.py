"""From a pillar to what acts on its body, and how receivers read it.

Masses, forces and energies of a body in one and two dimensions are per unit area or thickness;
`extent_of` turns them into those of the pillar.
"""

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import joint_law, resolved_joints
from jointwave.continuum.loads.ends import directions, fixed_ends, load_on, quiet_ends
from jointwave.continuum.loads.forces import Loads, pull_of, weight_of
from jointwave.continuum.receivers.sections import points_on_axis, sections
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.rock import layers_of
from jointwave.continuum.stepping.problem import Problem, Readings
from jointwave.joints.law import Law, stiffest


def extent_of(scene: Scene, body: Body) -> float:
    """Return the factor from integrals over a body's mesh to those over the pillar, m2, m or 1."""
    return float(scene.pillar.side ** (3 - body.x.shape[1]))


def problem_of(scene: Scene, found: SceneBody) -> Problem:
    """Return the body of a pillar and what acts on it all the time."""
    p, (body, law), stress = calibrate(scene), _with_law(scene, found), None
    if scene.prestress is not None:
        along = np.array(directions(body)) == 1
        stress = np.diag(np.where(along, scene.prestress.normal, 0.0))
    return Problem(
        body,
        readings_of(scene, found),
        law=law,
        stiffest=None if law is None else stiffest(law, scene),
        stress=stress,
        alpha=p.mass_damping or 0.0,
        mechanisms=mechanisms_of(scene, found.model),
        steady=weight_of(scene, body),
        quiet=quiet_ends(scene, body, found.model),
        held=fixed_ends(scene, body),
    )


def in_time(scene: Scene, problem: Problem, time: Clock) -> Problem:
    """Return a problem with the load and the motion of the base, for the steps of a clock."""
    body, pushes = problem.body, load_on(scene, problem.body)
    forces = Loads(body.stiffness.shape[0], time.dt, pushes, None) if pushes else None
    return problem._replace(forces=forces, held=fixed_ends(scene, body, time))


def _with_law(scene: Scene, found: SceneBody) -> tuple[Body, Law | None]:
    """Return the body of a pillar with the law of its joints, a column for each that is resolved;
    None without joints."""
    body, shears = found.body, found.body.components > 1
    if body.joints is None:
        return body, None
    p = calibrate(scene)
    joints = resolved_joints(p, found.model, shears, tuple(layers_of(scene)))
    number, column = np.unique(body.joints.column, return_inverse=True)
    law = joint_law(p, joints, number, shears)
    if law.maximum_closure is not None:
        law = law._replace(rock_compliance=0.0)
    return body._replace(joints=body.joints._replace(column=column.reshape(-1))), law


def readings_of(scene: Scene, found: SceneBody) -> Readings:
    """Return how a pillar's receivers read its body: motion, then rotation; stress over sections,
    that of rock by itself and that of joints among tractions."""
    body, area = found.body, scene.pillar.area / extent_of(scene, found.body)
    force = sections(body, found.materials, found.of_cell, scene.record.stress)
    constant = np.zeros(force.elastic.shape[0])
    if scene.prestress is not None:
        constant[:: body.components] = scene.prestress.normal
    if scene.gravity is not None:
        constant -= force.inertia @ pull_of(scene, body) / area
    points = force.contact.shape[1]
    return Readings(
        motion=points_on_axis(body, scene.record.velocity),
        stress=force.elastic / area,
        constant=constant,
        traction=force.contact / area,
        carried=np.zeros(force.contact.shape[0]),
        jump=csr_matrix((0, points)),
        viscous=None if body.damping is None else force.viscous / area,
        inertia=force.inertia / area,
    )
