"""Rigid blocks of a rock mass from its scene."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks as Cut
from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.material.contact_points import CUT
from jointwave.cases.material.rigid_blocks import RigidJoints, rigid_joints
from jointwave.cases.material.rock_mass import Stiffness, set_time_constants
from jointwave.cases.partition.joints import rocks_of
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.build import RigidBlocks
from jointwave.dem.columns import Columns, Rule, columns_of
from jointwave.dem.receivers import Faces, receivers_of
from jointwave.dem.rock_contacts import contacts_of
from jointwave.dem.sides import surroundings_of
from jointwave.dem.snapshots import Bodies, triangles
from jointwave.dem.waveforms import PointsAndJoints

#: Rotations of a block, by dimension.
ROTATIONS = {1: 0, 2: 1, 3: 3}
CORNERS = {2: 4, 3: 24}  # of a block, in snapshots


@dataclass(frozen=True, kw_only=True)
class BlocksOfRockMass(RigidBlocks):
    """A rock mass as rigid blocks.

    cut : the blocks. sides : names of the boundary's sides, in order. joints : the stiffness
    between blocks, and the homogenised stiffness.
    """

    scene: RockMass
    cut: Cut
    sides: tuple[str, ...]
    joints: RigidJoints

    @cached_property
    def faces(self) -> Faces:
        """The contacts as they are read."""
        met, excess = self.contacts, np.append(self.joints.excess, np.zeros((2, 1)), axis=1)
        own = excess[:, np.minimum(met.column, excess.shape[1] - 1)].T
        return Faces(met.blocks, met.area, met.frame, met.arm, own)

    @cached_property
    def receivers(self) -> PointsAndJoints:
        """What is recorded; raises SceneError for a point outside the rock."""
        return PointsAndJoints(*receivers_of(self.scene, self.cut, self.faces, self.onto))

    @property
    def bodies(self) -> Bodies:
        """Its blocks as snapshots show them: in the plane polygons and the slip of joints, in space
        the faces of polyhedra, in triangles."""
        cut, contacts, joints = self.cut, self.cut.contacts, None
        if self.dim == 2:
            of, pieces = np.arange(cut.count), cut.outlines
            shown = np.flatnonzero(contacts.of_joints(len(self.scene.joint_sets)))
            joints = contacts.ends[shown], shown
        else:
            of, _, pieces = cut.faces(shape_of(self.scene.domain).tolerance)
        owner, (cells, piece) = np.repeat(of, np.diff(pieces.first)), triangles(pieces)
        return Bodies(
            corners=pieces.corners,
            arms=pieces.corners - cut.centroid[owner],
            owner=owner,
            kind="triangle",
            cells=cells,
            block=of[piece],
            joints=joints,
            from_start=True,
        )


def blocks_of(scene: RockMass) -> BlocksOfRockMass:
    """Return the rigid blocks of a scene; raises SceneError if they cannot be made."""
    further, sides = further_sets(scene), shape_of(scene.domain).sides
    cut = blocks_of_scene(scene, further)
    try:
        contacts, kinds, others = contacts_of(scene, cut, sides, further)
    except GeometryError as error:  # periodic sides that do not fit each other
        raise SceneError(scene.where, error.key, None, str(error)) from None
    joints = rigid_joints(scene, further, kinds)
    density = np.array([one.density for one in rocks_of(scene)])[cut.body.region]
    gravity, stress, pressed, dim = np.zeros(cut.body.dim), None, 0.0, cut.body.dim
    if scene.gravity is not None:
        gravity = scene.gravity.acceleration * np.array(scene.gravity.direction)
    if scene.prestress is not None:
        stress = np.array(scene.prestress.tensor)
        pressed = float(np.abs(stress).max() * cut.boundary.area.sum())
    return BlocksOfRockMass(
        scene=scene,
        centroid=cut.centroid,
        size=cut.volume ** (1 / dim),
        contacts=contacts,
        columns=columns_of_sets(scene, joints, others),
        masses=masses_of(cut, density),
        gravity=gravity,
        prestress=stress,
        pressed=pressed,
        around=surroundings_of(scene, cut, sides),
        static_steps=40_000 + 40_000 * int(np.sqrt(cut.count)),
        corners=CORNERS[dim],
        counted_by="numerics.dem.block",
        cut=cut,
        sides=sides,
        joints=joints,
    )


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


def columns_of_sets(scene: RockMass, joints: RigidJoints, others: Stiffness) -> Columns:
    """Return the law of a scene's contacts.

    joints : of the sets. others : of further contacts, in separate columns, always linear.
    """
    sets, made = scene.joint_sets, len(joints.normal)
    normal = np.concatenate([joints.normal, others.normal])
    stiffness = np.stack([normal, np.concatenate([joints.shear, others.shear])])
    which = np.full(len(normal), len(sets))
    which[:made] = np.minimum(joints.kinds[:, 0], len(sets))
    rock = None
    if any(one.maximum_closure is not None for one in sets):  # at most all but a billionth of it
        rock = np.minimum(np.resize(joints.excess[0], len(normal)), (1 - 1e-9) / normal)
        rock[which == len(sets)] = 0.0
    eta, laws = _time_constants(scene, normal, stiffness[1], which), [*sets, JointLaw()]
    rules = _rules(scene, which)
    return columns_of(scene, laws, which, stiffness, eta=eta, rock=rock, rules=rules)


def _time_constants(
    scene: RockMass, normal: np.ndarray, shear: np.ndarray, which: np.ndarray
) -> np.ndarray | None:
    """Return viscosity over stiffness, normal and in shear [2, columns], s; None without any.

    A dashpot eta K of a joint within a contact of K' is one of eta K'^2 / K across the contact, to
    the first order in omega eta: rock beside the joint takes a part of its motion.
    """
    own = set_time_constants(scene)
    if own is None:
        return None
    sets, rayleigh = scene.joint_sets, scene.damping.rayleigh
    if rayleigh is not None:
        return np.full((2, len(normal)), rayleigh.coefficients[1])
    eta = np.zeros((2, len(normal)))
    for row, whole, key in zip(
        eta, (normal, shear), ("normal_stiffness", "shear_stiffness"), strict=True
    ):
        stiffness = np.array([*(getattr(one, key) for one in sets), np.inf])
        row[:] = np.append(own, 0.0)[which] * whole / stiffness[which]
    return eta


def _rules(scene: RockMass, which: np.ndarray) -> list[Rule]:
    """Return the rules of all columns, one where they are the same."""
    of_sets = [*((one.point_rule, one.contact_points) for one in scene.joint_sets), CUT]
    named: list[Rule] = [of_sets[k] for k in which]
    return named[:1] if len(set(named)) == 1 else named
