"""The rigid blocks of a rock mass."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks as Cut
from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError
from jointwave.cases.material.contact_points import CUT
from jointwave.cases.material.rigid_blocks import RigidJoints, rigid_joints, welds
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.partition.joints import ROCK, rocks_of
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import across_periodic, blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.joint import JointLaw, JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.blocks.rigid import ROTATIONS, RigidBlocks, masses_of, steady_fields
from jointwave.dem.contacts.faces import Contacts, contacts_of
from jointwave.dem.contacts.law import Columns, Rule, columns_of
from jointwave.dem.readings.receivers import receivers_of
from jointwave.dem.readings.snapshots import Bodies, triangles
from jointwave.dem.readings.waveforms import PointsAndJoints
from jointwave.dem.sides.domain import half_blocks, surroundings_of


@dataclass(frozen=True, kw_only=True)
class BlocksOfRockMass(RigidBlocks):
    """A rock mass as rigid blocks; left_over : part of the rock's stiffness that they lack."""

    scene: RockMass
    left_over: float
    corners: ClassVar[dict[int, int]] = {2: 4, 3: 24}
    counted_by: ClassVar[str] = "numerics.dem.block"

    @cached_property
    def receivers(self) -> PointsAndJoints:
        """Its receivers; raises SceneError for a point outside the rock."""
        return PointsAndJoints(*receivers_of(self.scene, self.cut, self.contacts, self.onto))

    @property
    def bodies(self) -> Bodies:
        """Bodies of its blocks for snapshots, in triangles: in the plane polygons, with the slip of
        joints; in space the faces of polyhedra."""
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
        )


def blocks_of(scene: RockMass) -> BlocksOfRockMass:
    """Return the rigid blocks of a rock mass; raises SceneError if the scene has no valid cut."""
    further, sides = further_sets(scene), shape_of(scene.domain).sides
    cut = blocks_of_scene(scene, further)
    try:
        across = [(one.contacts, one.shift) for one in across_periodic(scene, cut)]
    except GeometryError as error:  # periodic sides that do not fit each other
        raise SceneError(scene.where, error.key, None, str(error)) from None
    present = {sides[k] for k in np.unique(cut.boundary.side)}
    walls = tuple(one for one in scene.boundaries.sides("fixed", "roller") if one in present)
    contacts = contacts_of(cut, across, sides, walls)
    if not len(contacts.area):
        why = "leaves one block without a joint: make it smaller"
        raise SceneError(scene.where, "numerics.dem.block", scene.numerics.dem.block, why)
    kinds, column = _columns(scene, cut, contacts, len(further))
    alone = np.flatnonzero(column == NO_SET)
    column[alone] = len(kinds) + np.arange(len(alone))
    joints = rigid_joints(scene, further, kinds)
    excess = np.append(joints.excess, np.zeros((2, 1)), axis=1)[:, np.minimum(column, len(kinds))]
    others = _without_set(scene, cut, further, contacts, alone)
    density, dim = np.array([one.density for one in rocks_of(scene)])[cut.body.region], cut.body.dim
    gravity, stress = steady_fields(scene, dim)
    pressed = 0.0 if stress is None else float(np.abs(stress).max() * cut.boundary.area.sum())
    return BlocksOfRockMass(
        scene=scene,
        cut=cut,
        sides=sides,
        contacts=contacts._replace(column=column, excess=excess.T),
        columns=columns_of_sets(scene, joints, others),
        masses=masses_of(cut, density, ROTATIONS[dim]),
        gravity=gravity,
        prestress=stress,
        pressed=pressed,
        around=surroundings_of(scene, cut, sides),
        static_steps=40_000 + 40_000 * int(np.sqrt(cut.count)),
        left_over=joints.left_over,
    )


def _columns(
    scene: RockMass, cut: Cut, contacts: Contacts, further: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the `RigidJoints.kinds` [columns, 3], and the kind of each contact [c] or NO_SET."""
    joint_set = contacts.column
    if not scene.regions:
        sets = len(scene.joint_sets) + further
        return np.stack([np.arange(sets), *np.full((2, sets), ROCK)], axis=1), joint_set.copy()
    found, column = joint_set != NO_SET, np.full(len(joint_set), NO_SET)
    regions = np.sort(cut.body.region[contacts.blocks[found]], axis=1)
    kinds, own = np.unique(
        np.column_stack([joint_set[found], regions]), axis=0, return_inverse=True
    )
    column[found] = own.reshape(-1)  # its shape differs in numpy 2.0
    return kinds, column


def _without_set(
    scene: RockMass, cut: Cut, further: list[JointSet], contacts: Contacts, alone: np.ndarray
) -> np.ndarray:
    """Return normal and shear stiffness [2, n], Pa/m, of contacts without a joint set: those within
    intact rock, then those with walls.

    A contact with a fixed side is as stiff as the rock between the block's centroid and the side. A
    roller side has no shear stiffness.
    """
    pairs, centre, normal = contacts.blocks, contacts.centre, contacts.frame[:, 0]
    cuts, held = alone[pairs[alone, 1] < cut.count], alone[pairs[alone, 1] >= cut.count]
    j = pairs[cuts, 1]
    shift = centre[cuts] - cut.centroid[j] - contacts.arm[cuts, 1]
    inner = welds(scene, cut, further, pairs[cuts], centre[cuts], normal[cuts], shift)
    block, wall = pairs[held].T
    reach = (contacts.arm[held, 0] * normal[held]).sum(axis=1)
    kinds = [getattr(scene.boundaries, one) for one in contacts.walls]
    sticks = np.array([one == "fixed" for one in kinds], dtype=float)[wall - cut.count]
    k_n, k_s = half_blocks(scene, cut.body.region[block], reach).T
    return np.append(inner, [k_n, k_s * sticks], axis=1)


def columns_of_sets(scene: RockMass, joints: RigidJoints, others: np.ndarray) -> Columns:
    """Return the laws of all contacts.

    joints : of the joint sets. others : stiffness [2, n], Pa/m, of linear contacts without a set.
    """
    sets, made = scene.joint_sets, len(joints.normal)
    stiffness = np.append([joints.normal, joints.shear], others, axis=1)
    normal = stiffness[0]
    which = np.full(len(normal), len(sets))
    which[:made] = np.minimum(joints.kinds[:, 0], len(sets))
    rock = None
    if any(one.maximum_closure is not None for one in sets):  # rock compliance < the contact's
        rock = np.minimum(np.resize(joints.excess[0], len(normal)), (1 - 1e-9) / normal)
        rock[which == len(sets)] = 0.0
        rayleigh = scene.damping.rayleigh  # damps rock as it does joints
        rock = np.stack([rock, np.full_like(rock, rayleigh.coefficients[1] if rayleigh else 0.0)])
    eta, laws = _time_constants(scene, stiffness, which), [*sets, JointLaw()]
    of_sets = [*((one.point_rule, one.contact_points) for one in sets), CUT]
    rules: list[Rule] = [of_sets[k] for k in which]
    rules = rules[:1] if len(set(rules)) == 1 else rules
    return columns_of(scene, laws, which, stiffness, eta=eta, rock=rock, rules=rules)


def _time_constants(scene: RockMass, stiffness: np.ndarray, which: np.ndarray) -> np.ndarray | None:
    """Return viscosity over stiffness, normal and in shear [2, columns], s; None without dashpots.

    A dashpot eta K of a joint of stiffness K, in a contact of K' (joint and rock in series), acts
    across the contact as eta K'^2 / K, to first order in omega eta.
    """
    own = set_time_constants(scene)
    if own is None:
        return None
    if scene.damping.rayleigh is not None:
        return np.full_like(stiffness, scene.damping.rayleigh.coefficients[1])
    of_sets = [(one.normal_stiffness, one.shear_stiffness) for one in scene.joint_sets]
    of_joints = np.array([*of_sets, (np.inf, np.inf)]).T
    return np.append(own, 0.0)[which] * stiffness / of_joints[:, which]
