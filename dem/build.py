"""Rigid blocks of a rock mass from its scene, and the constants of their steps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks as Cut
from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.material.rigid_blocks import RigidJoints, rigid_joints
from jointwave.cases.partition.blocks import Partition, plane_partition
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import rocks_of
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.boundaries import freedoms
from jointwave.dem.chunks import Chunks, chunks_of
from jointwave.dem.columns import Columns, columns, points_on
from jointwave.dem.contacts import Contacts, contacts_of
from jointwave.dem.model import Blocks, KernelFlags
from jointwave.dem.receivers import Faces
from jointwave.dem.stability import critical_time_step
from jointwave.joints.law import Law, parts_of
from jointwave.joints.normal import gap_under

#: Rotations of a block, by dimension.
ROTATIONS = {1: 0, 2: 1, 3: 3}


@dataclass(frozen=True)
class RigidBlocks:
    """A rock mass as rigid blocks, before time discretisation.

    cut : the blocks. sides : names of the boundary's sides, in order. masses : matrices of mass,
    kg, and of inertia, kg m2, of each block [N, F, F]. joints : the stiffness between blocks, and
    the homogenised stiffness.
    """

    scene: RockMass
    cut: Cut
    sides: tuple[str, ...]
    contacts: Contacts
    columns: Columns
    masses: np.ndarray
    joints: RigidJoints

    @property
    def dim(self) -> int:
        """Number of dimensions."""
        return self.cut.body.dim

    @cached_property
    def partition(self) -> Partition:
        """The blocks in the plane, with the corners of each."""
        names = tuple(one.name for one in self.scene.joint_sets)
        return plane_partition(self.cut, self.sides, names)

    @cached_property
    def onto(self) -> np.ndarray:
        """`boundaries.freedoms`."""
        return freedoms(self.dim, ROTATIONS[self.dim])

    @cached_property
    def inertia(self) -> np.ndarray:
        """Mass and moments of inertia of each block [N, F]."""
        return np.ascontiguousarray(np.diagonal(self.masses, axis1=1, axis2=2))

    @cached_property
    def points(self) -> np.ndarray:
        """`columns.points_on`, where joints can fail."""
        return points_on(self.contacts, self.columns.rules)

    @property
    def critical(self) -> float:
        """A lower bound of the critical step, s."""
        local = self.scene.damping.local or 0.0
        return critical_time_step(self.contacts, self.columns, self.masses, local)


def rigid_blocks(scene: RockMass) -> RigidBlocks:
    """Return the rigid blocks of a scene; raises SceneError if they cannot be made."""
    further, sides = further_sets(scene), shape_of(scene.domain).sides
    cut = blocks_of_scene(scene, further)
    try:
        found = contacts_of(scene, cut, sides, further)
    except GeometryError as error:  # periodic sides that do not fit each other
        raise SceneError(scene.where, error.key, None, str(error)) from None
    joints = rigid_joints(scene, further, found.kinds)
    density = np.array([one.density for one in rocks_of(scene)])[cut.body.region]
    own = columns(scene, joints, found.others)
    return RigidBlocks(scene, cut, sides, found, own, masses_of(cut, density), joints)


def masses_of(cut: Cut, density: np.ndarray) -> np.ndarray:
    """Return the matrices of mass and inertia about the centroids [N, F, F] of blocks of densities
    [N], kg/m3."""
    dim, second = cut.body.dim, cut.second_moment
    found = np.zeros((cut.count, *[dim + ROTATIONS[dim]] * 2))
    found[:, :dim, :dim] = cut.volume[:, None, None] * np.eye(dim)
    polar = np.trace(second, axis1=1, axis2=2)
    if dim == 2:
        found[:, 2, 2] = polar
    elif dim == 3:
        found[:, 3:, 3:] = polar[:, None, None] * np.eye(3) - second
    return density[:, None, None] * found


def form_of(blocks: RigidBlocks, held: bool, shaken: bool) -> KernelFlags:
    """Return the effects of a rock mass."""
    scene, own, dim = blocks.scene, blocks.columns, blocks.dim
    return KernelFlags(
        dim=dim,
        turns=dim > 1,
        parts=parts_of(own.law)._replace(planar=dim == 2),
        points=blocks.points.shape[1] if own.fails else 0,
        mass_damping=scene.damping.alpha is not None,
        local_damping=bool(scene.damping.local),
        gravity=scene.gravity is not None,
        held=held,
        ledger=scene.record.energy,
        stressed=scene.prestress is not None,
        shaken=shaken,
        relaxed=relaxed(scene),
        oblique=coupled(blocks.masses),
    )


def coupled(masses: np.ndarray) -> bool:
    """Return whether rotations of some block about different axes have inertia in common."""
    diagonal = np.diagonal(masses, axis1=1, axis2=2)
    apart = masses - diagonal[:, :, None] * np.eye(masses.shape[1])
    return bool((np.abs(apart) > 1e-12 * diagonal[:, -1, None, None]).any())


def relaxed(scene: RockMass) -> bool:
    """Return whether a scene asks for a static state, by dynamic relaxation."""
    gravity, quiet = scene.gravity, bool(scene.boundaries.sides("quiet"))
    weighed = gravity is not None and (gravity.static or quiet)
    return weighed or scene.prestress is not None


def constants(blocks: RigidBlocks, dt: float) -> Blocks:
    """Return the constants of the blocks for steps of dt, s."""
    scene, g = blocks.scene, np.zeros(blocks.dim)
    drag = 0.5 * dt * (scene.damping.alpha or 0.0)
    if scene.gravity is not None:
        g = scene.gravity.acceleration * np.array(scene.gravity.direction)
    tensor = blocks.masses[:, blocks.dim :, blocks.dim :]
    return Blocks(
        inertia=blocks.inertia,
        dt=dt,
        keep=(1 - drag) / (1 + drag),
        local=scene.damping.local or 0.0,
        gravity=g,
        tensor=np.ascontiguousarray(tensor) if coupled(blocks.masses) else None,
    )


def chunks(blocks: RigidBlocks) -> Chunks:
    """Return the table of contacts, with their tractions under a prestress."""
    own, met = blocks.columns, blocks.contacts
    upper = ((), ((0, 0),), ((0, 0), (1, 1), (0, 1)))[blocks.dim - 1]
    share = own.bending[met.column] * met.area
    second = np.array([share * met.spread[:, i, j] for i, j in upper])
    return chunks_of(
        faces_of(blocks),
        blocks.cut.count,
        blocks.masses.shape[1],
        law=met.column if parts_of(own.law).varied else None,
        start=None if blocks.scene.prestress is None else carried(blocks),
        points=blocks.points if own.fails else None,
        second=None if own.fails else second.T,
    )


def faces_of(blocks: RigidBlocks) -> Faces:
    """Return the contacts as they are read."""
    met, excess = blocks.contacts, np.append(blocks.joints.excess, np.zeros((2, 1)), axis=1)
    own = excess[:, np.minimum(met.column, excess.shape[1] - 1)].T
    return Faces(met.blocks, met.area, met.frame, met.arm, own)


def carried(blocks: RigidBlocks) -> np.ndarray:
    """Return the gap and the slips that stand for the prestress in each contact [c, d], m."""
    met, own, stress = blocks.contacts, blocks.columns, blocks.scene.prestress
    assert stress is not None
    traction = np.einsum("cak,kl,cl->ca", met.frame, stress.tensor, met.frame[:, 0])
    law = Law(*(x[met.column] if np.ndim(x) else x for x in own.law))
    gap, shear = gap_under(law, parts_of(law), traction[:, 0]), own.shear[met.column, None]
    still = np.zeros_like(traction[:, 1:])  # on rollers
    return np.column_stack([gap, -np.divide(traction[:, 1:], shear, out=still, where=shear > 0)])
