"""The rigid blocks of a pillar: in one dimension where all motion is axial, else in space."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from jointwave.cases.geometry.blocks import Blocks as Cut
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.partition.pillar import SIDES, blocks_of_pillar
from jointwave.cases.run_memory import refuse_beyond_memory
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene
from jointwave.dem.blocks.rigid import ROTATIONS, RigidBlocks, masses_of, steady_fields
from jointwave.dem.contacts.faces import Contacts, contacts_of
from jointwave.dem.contacts.law import Columns, columns_of
from jointwave.dem.readings.sections import Sections, sections_of
from jointwave.dem.readings.snapshots import Bodies
from jointwave.dem.sides.ends import surroundings_of, under_weight
from jointwave.results.subcells import CORNERS

CUT = {1: 400, 3: 12_000}  # bytes a block while a pillar is cut


@dataclass(frozen=True, kw_only=True)
class BlocksOfPillar(RigidBlocks):
    """A pillar as rigid blocks, one after the other; y runs along it, its axis is x = z = 0."""

    scene: Scene
    corners: ClassVar[dict[int, int]] = {1: 8, 3: 8}
    counted_by: ClassVar[str] = "pillar.block"

    @cached_property
    def receivers(self) -> Sections:
        """Its receivers."""
        return sections_of(self.scene, len(self.contacts.walls))

    @property
    def bodies(self) -> Bodies:
        """Its blocks as hexahedra, for snapshots."""
        sides = np.stack(np.broadcast_arrays(self.scene.pillar.side, self.size), axis=1)
        arms = (np.array(CORNERS["hexahedron"]) - 0.5) * sides[:, None, [0, 1, 0]]
        block, centres = np.arange(self.count), np.zeros((self.count, 1, 3))
        centres[:, 0, 1] = self.centroid[:, self.dim // 2]
        return Bodies(
            corners=(centres + arms).reshape(-1, 3),
            arms=arms.reshape(-1, 3),
            owner=np.repeat(block, 8),
            kind="hexahedron",
            cells=np.arange(8 * self.count).reshape(-1, 8),
            block=block,
            joints=None,
        )


def blocks_of(scene: Scene) -> BlocksOfPillar:
    """Return the rigid blocks of a pillar; raises SceneError if they do not fit in memory."""
    dim = 3 if scene.is_spatial else 1
    refuse_beyond_memory(scene, {"pillar.block": CUT[dim] * scene.block_count})
    p, cut = calibrate(scene), cut_of(scene, dim)
    rotations = ROTATIONS[dim] if scene.motion.rotation != "none" else 0
    contacts = contacts_of(cut, [], SIDES, tuple(scene.ends.sides("fixed")))
    columns = columns_of_pillar(scene, p, contacts, rotations > 0)
    masses = masses_of(cut, np.array([one.density for one in p.each])[p.segment], rotations)
    (gravity, stress), placed = steady_fields(scene, dim), None
    moved = under_weight(scene, p, masses[:, 0, 0] * gravity[dim // 2])
    if moved is not None:
        placed = np.zeros(masses.shape[:2])
        placed[:, dim // 2] = moved
    return BlocksOfPillar(
        scene=scene,
        cut=cut,
        sides=SIDES,
        contacts=contacts._replace(column=np.arange(len(contacts.area))),
        columns=columns,
        masses=masses,
        gravity=gravity,
        prestress=stress,
        pressed=p.area * abs(scene.prestress.normal) if scene.prestress else 0.0,
        around=surroundings_of(scene, cut, columns.bending[0], rotations, stress),
        static_steps=40_000 + 80_000 * cut.count,
        finite=rotations > 0 and scene.motion.rotation == "finite",
        composed=scene.numerics.dem.scheme == "fourth-order",
        in_row=True,
        placed=placed,
    )


def cut_of(scene: Scene, dim: int) -> Cut:
    """Return the blocks of a pillar, with full volumes and areas in any number of dimensions."""
    cut, section = blocks_of_pillar(scene, dim), scene.left_out(dim)
    contacts, boundary = (
        replace(one, area=section * one.area, second_moment=section * one.second_moment)
        for one in (cut.contacts, cut.boundary)
    )
    return replace(
        cut,
        volume=section * cut.volume,
        second_moment=section * cut.second_moment,
        contacts=contacts,
        boundary=boundary,
    )


def columns_of_pillar(scene: Scene, p: Properties, contacts: Contacts, turns: bool) -> Columns:
    """Return the joint laws of the contacts, one column each."""
    walls = [p.at_start if one == "start" else p.at_end for one in contacts.walls]
    normal = np.append(p.stiffness, [one.wall_stiffness for one in walls])
    shear = np.append(p.shear_stiffness, [one.wall_shear_stiffness for one in walls])
    eta, rock, rest = p.joint_time_constant, p.rock_compliance, np.zeros(len(walls))
    if rock is not None:
        rock = np.array([np.append(one, rest) for one in (rock, p.rock_time_constant)])
    which = np.where(contacts.column == NO_SET, 1 + len(scene.layers), contacts.column)
    rule = scene.joints.point_rule, scene.joints.contact_points
    return columns_of(
        scene,
        [scene.joints, *scene.layers, JointLaw()][: which.max() + 1],
        which,
        np.stack([normal, shear]),
        eta=None if eta is None else np.tile(np.append(eta, rest), (2, 1)),
        rock=rock,
        rules=[rule if turns else ("midpoint", 1)],
        shears=contacts.frame.shape[1] > 1,
    )
