"""Rigid blocks of a rock mass from its scene, and the constants of their steps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rigid_blocks import RigidJoints, rigid_joints
from jointwave.cases.material.rock_mass import Inertia, inertia
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import rocks_of
from jointwave.cases.partition.scene import partition_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.blocks.joints import Columns, columns
from jointwave.dem.blocks.links import Links, links_of
from jointwave.dem.blocks.stability import critical_plane_step
from jointwave.dem.contacts import Contacts, contacts_of
from jointwave.dem.model import Blocks, KernelFlags
from jointwave.dem.receivers import Faces, frames_of
from jointwave.joints.law import Law, parts_of
from jointwave.joints.normal import gap_under


class RigidBlocks(NamedTuple):
    """A rock mass as rigid blocks, before time discretisation.

    joints : the stiffness between blocks, and the homogenised stiffness.
    """

    scene: RockMass
    partition: Partition
    links: Links
    columns: Columns
    inertia: Inertia
    joints: RigidJoints

    @property
    def masses(self) -> np.ndarray:
        """Mass (kg/m), twice, and moment of inertia (kg m) of each block [N, 3]."""
        return np.stack([self.inertia.mass, self.inertia.mass, self.inertia.moment], axis=1)

    @property
    def critical(self) -> float:
        """A lower bound of the critical step, s."""
        local = self.scene.damping.local or 0.0
        return critical_plane_step(self.links, self.columns, self.inertia, local)


def rigid_blocks(scene: RockMass) -> RigidBlocks:
    """Return the rigid blocks of a scene; raises SceneError if they cannot be made."""
    further = further_sets(scene)
    partition = partition_of(scene, further)
    links = links_of(scene, partition, further)
    joints = rigid_joints(scene, further, links.kinds)
    found = columns(scene, joints, links.others)
    density = np.array([one.density for one in rocks_of(scene)])
    own = inertia(partition, density[partition.region])
    return RigidBlocks(scene, partition, links, found, own, joints)


def form_of(blocks: RigidBlocks, held: bool, shaken: bool) -> KernelFlags:
    """Return the effects of a rock mass."""
    scene, own = blocks.scene, blocks.columns
    return KernelFlags(
        dim=2,
        turns=True,
        parts=parts_of(own.law)._replace(planar=True),
        points=own.points,
        mass_damping=scene.damping.alpha is not None,
        local_damping=bool(scene.damping.local),
        gravity=scene.gravity is not None,
        held=held,
        ledger=scene.record.energy,
        stressed=scene.prestress is not None,
        shaken=shaken,
        relaxed=relaxed(scene),
    )


def relaxed(scene: RockMass) -> bool:
    """Return whether a scene asks for a static state, by dynamic relaxation."""
    gravity, quiet = scene.gravity, bool(scene.boundaries.sides("quiet"))
    weighed = gravity is not None and (gravity.static or quiet)
    return weighed or scene.prestress is not None


def constants(scene: RockMass, blocks: RigidBlocks, dt: float) -> Blocks:
    """Return the constants of the blocks for steps of dt, s."""
    drag, g = 0.5 * dt * (scene.damping.alpha or 0.0), np.zeros(2)
    if scene.gravity is not None:
        g = scene.gravity.acceleration * np.array(scene.gravity.direction)
    return Blocks(
        inertia=blocks.masses,
        dt=dt,
        keep=(1 - drag) / (1 + drag),
        local=scene.damping.local or 0.0,
        gravity=g,
    )


def contacts(blocks: RigidBlocks) -> Contacts:
    """Return the table of contacts, with their tractions under a prestress."""
    links, own, faces = blocks.links, blocks.columns, faces_of(blocks)
    rules = own.rules[links.column if len(own.rules) > 1 else np.zeros(len(faces.area), dtype=int)]
    points, second = None, None
    if own.points:
        points = faces.area[:, None, None] * rules.swapaxes(1, 2)
    else:
        second = faces.area**3 * (rules[:, 1] * rules[:, 0] ** 2).sum(axis=1)
    return contacts_of(
        faces,
        blocks.partition.count,
        blocks.masses.shape[1],
        law=links.column if parts_of(own.law).varied else None,
        start=None if blocks.scene.prestress is None else carried(blocks),
        points=points,
        second=second,
    )


def faces_of(blocks: RigidBlocks) -> Faces:
    """Return the contacts as they are read."""
    links, excess = blocks.links, np.append(blocks.joints.excess, np.zeros((2, 1)), axis=1)
    centre, edge = (links.start + links.end) / 2, links.end - links.start
    return Faces(
        blocks=links.blocks,
        area=np.hypot(*edge.T),
        frame=frames_of(links.normal),
        arm=np.stack([centre - links.beside_i, centre - links.beside_j], axis=1),
        excess=excess[:, np.minimum(links.column, excess.shape[1] - 1)].T,
    )


def carried(blocks: RigidBlocks) -> np.ndarray:
    """Return the opening and the slip that stand for the prestress in each contact [c, 2], m."""
    links, own, stress = blocks.links, blocks.columns, blocks.scene.prestress
    assert stress is not None
    traction = links.normal @ np.array([[stress.xx, stress.xy], [stress.xy, stress.yy]])
    along = np.stack([-links.normal[:, 1], links.normal[:, 0]], axis=1)
    t_n, t_s = ((traction * axis).sum(axis=1) for axis in (links.normal, along))
    law = Law(*(x[links.column] if np.ndim(x) else x for x in own.law))
    shear = own.shear[links.column]
    slip = -np.divide(t_s, shear, out=np.zeros(len(t_s)), where=shear > 0)  # none on rollers
    return np.stack([gap_under(law, parts_of(law), t_n), slip], axis=1)
