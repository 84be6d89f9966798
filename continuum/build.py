"""From a scene to the constants of its run."""

from __future__ import annotations

from math import ceil, sqrt
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags, identity, kron

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.constant_q import Mechanisms, mechanisms_of
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.ends import build_ends, end_stiffness, fixed_ends
from jointwave.continuum.explicit.critical import any_motion, critical_time_step
from jointwave.continuum.joints import interfaces, joint_law, resolved_joints
from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.mesh.given import given_mesh
from jointwave.continuum.mesh.pillar import elements_in_block, pillar_mesh
from jointwave.continuum.model import Fixed, Interfaces, Model, Receivers, RockOperators, memory_of
from jointwave.continuum.plane.discrete import PlaneDiscrete
from jointwave.continuum.size import refuse_large_file, refuse_large_mesh, resolved_period
from jointwave.continuum.space.assembly import body_and_jumps
from jointwave.continuum.space.body import Body, rock_matrices
from jointwave.continuum.space.elasticity import Material
from jointwave.continuum.space.interface import Jumps
from jointwave.continuum.space.kinematics import Kinematics, kinematics, layer_thickness, materials
from jointwave.continuum.space.receivers import points, sections
from jointwave.numerics.cache_lines import zeros


class Discrete(NamedTuple):
    """A scene in space: its numbers, how it moves, its rock and its joints (None without)."""

    properties: Properties
    kinematics: Kinematics
    materials: list[Material]
    body: Body
    jumps: Jumps | None
    joints: Interfaces | None


def discretise(scene: Scene, model: str, dim: int | None = None, comm=None) -> Discrete:
    """Return a scene in space; `model` is "jointed" or "equivalent".

    comm : mpi4py's communicator of the processes that share it; None for a single process.
    """
    p, motion, numerics = calibrate(scene), kinematics(scene, dim), scene.numerics.continuum
    mesh = mesh_of(scene, p, model, motion)
    rock = materials(scene, p, model, mesh.layers)
    consistent = numerics.mass == "consistent"
    asked = mesh, numerics.order, rock, motion.section, motion.plane_sections, consistent
    body, across = body_and_jumps(comm, *asked)
    if across is None:
        return Discrete(p, motion, rock, body, None, None)
    law = joint_law(
        p,
        resolved_joints(p, model, motion.shears, mesh.layers),
        across.joint,
        motion.shears,
    )
    prestress = scene.prestress.normal if scene.prestress else None
    carried = None
    if prestress:
        carried = np.zeros((len(across.matrices), across.weight.size))
        carried[0] = prestress
    return Discrete(p, motion, rock, body, across, interfaces(across, law, carried, scene))


def mesh_of(scene: Scene, p: Properties, model: str, motion: Kinematics) -> Mesh:
    """Return the mesh of a scene's pillar: its own file, or blocks."""
    numerics = scene.numerics.continuum
    if numerics.mesh_path is not None:
        refuse_large_file(scene)
        return given_mesh(numerics.mesh_path, scene, p, motion.dim)
    layers = layer_thickness(scene, p)
    cut = resolved_joints(p, model, motion.shears, tuple(layers)).number
    elements = [numerics.elements_per_block or elements_for(scene, one, model) for one in p.each]
    blocks = [one.block_count for one in p.each]
    refuse_large_mesh(scene, motion, ceil(np.average(elements, weights=blocks)))
    try:
        return pillar_mesh(
            p, motion.dim, numerics.cell, elements, numerics.elements_across, cut, layers
        )
    except ImportError as error:
        key = "numerics.continuum.cell"
        raise SceneError(scene.where, key, numerics.cell, f"needs gmsh ({error})") from None


def elements_for(scene: Scene, p: JointedRock, model: str) -> int:
    """Return how many elements a block needs along the pillar to resolve the scene's waves."""
    modulus = p.modulus if model == "equivalent" else p.intact_modulus
    assert modulus is not None
    speed = sqrt(modulus / p.density)
    return elements_in_block(p.spacing, speed, resolved_period(scene), damped=bool(p.time_constant))


def critical_step_of(scene: Scene, discrete: Discrete, model: str) -> float:
    """Return the critical step (s) with all joints closed, the stiffest state in reach."""
    p, body = discrete.properties, discrete.body
    springs = end_stiffness(scene, p, body, model)
    return critical_step(discrete, fixed_ends(scene, body), springs)


def critical_step(
    discrete: Discrete | PlaneDiscrete, given: Fixed | None, springs: np.ndarray | None = None
) -> float:
    """Return the critical step (s) of rock and closed joints; given : freedoms whose motion is
    given; springs : at the ends, N/m [freedoms], None without."""
    body = discrete.body
    stiffness, viscosity = operators(discrete)
    if springs is not None:
        stiffness = stiffness + diags(springs)
    fixed = np.zeros(0, dtype=np.int64) if given is None else given.freedom
    assembled = body.mass, stiffness, viscosity, fixed, any_motion(body)
    if body.communicator.size == 1:
        return critical_time_step(*assembled)
    from jointwave.continuum.parallel.communicator import Communicator  # with mpi4py
    from jointwave.continuum.parallel.critical import shared_critical_step

    assert isinstance(body.communicator, Communicator)
    return shared_critical_step(body.communicator, *assembled)


def operators(discrete: Discrete | PlaneDiscrete) -> tuple[csr_matrix, csr_matrix | None]:
    """Return the stiffness (N/m) and viscosity (N s/m) of rock and closed joints, None without
    dashpots."""
    stiffness, viscosity = rock_matrices(discrete.body)
    joints = discrete.joints
    if joints is None:
        return stiffness, viscosity
    law = joints.law
    stiffness = stiffness + _of_joints(joints, *joints.stiffest)
    if law.normal_viscosity is not None:
        dashpots = _of_joints(joints, law.normal_viscosity, law.shear_viscosity)
        viscosity = dashpots if viscosity is None else viscosity + dashpots
    return stiffness, viscosity


def _of_joints(joints: Interfaces, normal, shear) -> csr_matrix:
    """Return B^T W k B of all joints: k along the normal, and another along the joint."""
    of_direction = [normal, *(joints.directions - 1) * [0.0 if shear is None else shear]]
    weights = np.concatenate([joints.area * k for k in of_direction])
    return csr_matrix(joints.jump.T @ diags(weights) @ joints.jump)


def build_model(
    scene: Scene, discrete: Discrete, model: str, time: Clock, read: Receivers | None = None
) -> Model:
    """Return the constants of a scene in space, for a given clock; read : its receivers, where they
    are known, which take longer than all else."""
    p, body = discrete.properties, discrete.body
    mass = body.communicator.total(body.mass)
    return Model(
        rock=rock_operators(body, mass, time.dt, p.mass_damping, mechanisms_of(scene, model)),
        interfaces=discrete.joints,
        ends=build_ends(scene, p, body, model, time, mass),
        weight=weight_of(scene, body),
        receivers=read or receivers(scene, discrete),
        dt=time.dt,
    )


def rock_operators(
    body: Body,
    mass: np.ndarray,
    dt: float,
    damping: float | None,
    mechanisms: Mechanisms | None,
) -> RockOperators:
    """Return the rock of a body; mass : of all processes together [freedoms], kg; damping : of
    mass-proportional damping, 1/s, None without; mechanisms : of its relaxation, None without."""
    alpha, step = (damping or 0.0) * dt / 2, zeros(mass.size)
    # Massless nodes, of another process's cell beyond a joint, do not move.
    np.divide(dt / (1 + alpha), mass, out=step, where=mass > 0)
    decay = None if damping is None else (1 - alpha) / (1 + alpha)
    memory = None if mechanisms is None else memory_of(mechanisms, dt)
    return RockOperators(body.stiffness, body.viscosity, body.mass, step, decay, memory)


def weight_of(scene: Scene | RockMass, body: Body) -> np.ndarray | None:
    """Return the weight on every freedom, N; None without gravity."""
    pull = pull_of(scene, body)
    if pull is None:
        return None
    return body.mass * pull if body.consistent is None else body.consistent @ pull


def pull_of(scene: Scene | RockMass, body: Body) -> np.ndarray | None:
    """Return the acceleration of gravity on every freedom, m/s2; None without gravity."""
    if scene.gravity is None:
        return None
    components = body.section.components
    pull = np.array(scene.gravity.direction, dtype=float) * scene.gravity.acceleration
    found = np.zeros(body.mass.size)
    nodes = np.arange(len(body.x))
    for c in range(components):
        found[body.freedom(nodes, c)] = pull[1 if components == 1 else c]
    return found


def receivers(scene: Scene, discrete: Discrete) -> Receivers:
    """Return how a scene's places are read, stresses over the pillar's section."""
    body, area = discrete.body, discrete.properties.area
    motion, pull = points(body, scene.record.velocity), pull_of(scene, body)
    force = sections(body, discrete.jumps, discrete.materials, scene.record.stress)
    # Alike on all processes that have joints, which then share what is compiled.
    viscous, contact = (
        body.communicator.any(part.nnz > 0) for part in (force.viscous, force.contact)
    )
    constant = np.zeros(force.elastic.shape[0])
    if pull is not None:
        constant -= (force.inertia / area) @ pull
    tractions, joints = None, discrete.joints
    if contact and joints is not None:
        per_point = force.contact / area
        tractions = kron(identity(joints.directions), per_point @ diags(1 / joints.area))
        if joints.prestress is not None:
            constant[: per_point.shape[0]] += per_point @ joints.prestress[0]
    return Receivers(
        point=motion.motion,
        turn=motion.turn,
        elastic=force.elastic / area,
        viscous=force.viscous / area if viscous else None,
        inertia=force.inertia / area,
        contact=tractions,
        constant=constant if constant.any() else None,
    )
