"""The rigid blocks of a pillar: of length alone where all motion is along it, else in space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.run_memory import refuse_beyond_memory
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene
from jointwave.dem.build import RigidBlocks
from jointwave.dem.columns import Columns, columns_of
from jointwave.dem.contacts import Contacts
from jointwave.dem.ends import Face, surroundings_of, under_weight
from jointwave.dem.sections import Sections, sections_of
from jointwave.dem.snapshots import Bodies
from jointwave.results.subcells import CORNERS

ENDS = "start", "end"
CUT = 400  # bytes of a block while a pillar is cut


@dataclass(frozen=True, kw_only=True)
class BlocksOfPillar(RigidBlocks):
    """A pillar as rigid blocks, one after the other; y runs along it, its axis is x = z = 0.

    properties : their numbers. The last contacts join the first and the last block to walls, where
    these ends are fixed.
    """

    scene: Scene
    properties: Properties

    @cached_property
    def receivers(self) -> Sections:
        """What is recorded."""
        return sections_of(self.scene.record, self.properties, len(self.contacts.walls))

    @property
    def bodies(self) -> Bodies:
        """Its blocks in space, as snapshots show them: hexahedra."""
        sides = np.stack(np.broadcast_arrays(self.properties.side, self.size), axis=1)[:, [0, 1, 0]]
        arms = (np.array(CORNERS["hexahedron"]) - 0.5) * sides[:, None]
        block, centres = np.arange(self.count), np.zeros((self.count, 1, 3))
        centres[:, 0, 1] = self.properties.centre_y
        return Bodies(
            corners=(centres + arms).reshape(-1, 3),
            arms=arms.reshape(-1, 3),
            owner=np.repeat(block, 8),
            kind="hexahedron",
            cells=np.arange(8 * self.count).reshape(-1, 8),
            block=block,
            joints=None,
            from_start=False,
        )


def blocks_of(scene: Scene) -> BlocksOfPillar:
    """Return the rigid blocks of a pillar; raises SceneError for more than memory holds."""
    refuse_beyond_memory(scene, {"pillar.block": CUT * scene.block_count})
    p, dim = calibrate(scene), 3 if is_spatial(scene) else 1
    count, along = p.block_count, dim // 2
    axes, turns = ([0, 1, 2] if dim == 3 else [1]), dim == 3 and scene.motion.rotation != "none"
    gravity, stress, pressed = np.zeros(3), None, 0.0
    if scene.gravity is not None:
        gravity = scene.gravity.acceleration * np.array(scene.gravity.direction)
    if scene.prestress is not None:
        stress = np.zeros((dim, dim))
        stress[along, along] = scene.prestress.normal
        pressed = p.area * abs(scene.prestress.normal)
    centroid = np.zeros((count, dim))
    centroid[:, along] = p.centre_y
    contacts, masses = contacts_of(scene, p, dim), masses_of(p, dim, turns)
    columns = columns_of_pillar(scene, p, contacts, turns)
    spread = columns.bending[0] * p.area / 12 * np.eye(dim - 1)
    face, placed = Face(p.area, spread, masses.shape[1] - dim), None
    moved = under_weight(scene, p, masses[:, 0, 0] * gravity[1])
    if moved is not None:
        placed = np.zeros(masses.shape[:2])
        placed[:, along] = moved
    return BlocksOfPillar(
        scene=scene,
        centroid=centroid,
        size=np.diff(p.contact_y),
        contacts=contacts,
        columns=columns,
        masses=masses,
        gravity=gravity[axes],
        prestress=stress,
        pressed=pressed,
        around=surroundings_of(scene, p, centroid, face, stress),
        static_steps=40_000 + 80_000 * count,
        corners=8,
        counted_by="pillar.block",
        finite=turns and scene.motion.rotation == "finite",
        composed=scene.numerics.dem.scheme == "fourth-order",
        in_row=True,
        placed=placed,
        properties=p,
    )


def masses_of(p: Properties, dim: int, turns: bool) -> np.ndarray:
    """Return the matrices of mass and inertia of the blocks [N, F, F]."""
    mass = np.full(p.block_count, p.block_mass) if p.masses is None else p.masses
    if dim == 1:
        return mass[:, None, None]
    parts = [mass] * 3
    if turns:
        whole = p.inertia_across, p.inertia_along, p.inertia_across
        parts += [mass * (one / p.block_mass) for one in whole]
    return np.stack(parts, axis=1)[:, :, None] * np.eye(len(parts))


def contacts_of(scene: Scene, p: Properties, dim: int) -> Contacts:
    """Return the contacts of a pillar: between its blocks, then with the walls of fixed ends.

    The frame of those between blocks is y, z, x, so that the normal points along the pillar.
    """
    kinds, count = (scene.ends.start, scene.ends.end), p.block_count
    walls = tuple(name for name, kind in zip(ENDS, kinds, strict=True) if kind == "fixed")
    first, last = (0 if one == "start" else count - 1 for one in ENDS)
    held = np.array([first if one == "start" else last for one in walls], dtype=int)
    outwards = np.array([-1.0 if one == "start" else 1.0 for one in walls])
    k, half = np.arange(count - 1), np.diff(p.contact_y) / 2
    i = np.concatenate([k, held])
    sign = np.concatenate([np.ones(count - 1), outwards])
    normal, arm = np.zeros((len(i), dim)), np.zeros((len(i), 2, dim))
    normal[:, dim // 2] = sign
    arm[:, 0, dim // 2] = sign * half[i]
    arm[: count - 1, 1, dim // 2] = -half[1:]
    frame = normal[:, None]
    if dim == 3:
        frame = np.zeros((len(i), 3, 3))
        frame[:, 0, 1], frame[:, 1, 2], frame[:, 2, 0] = sign, sign, 1.0
    centre = np.zeros((len(i), dim))
    centre[:, dim // 2] = p.contact_y[np.where(sign > 0, i + 1, 0)]
    return Contacts(
        blocks=np.stack([i, np.concatenate([k + 1, count + np.arange(len(walls))])], axis=1),
        area=np.full(len(i), p.area),
        centre=centre,
        frame=frame,
        arm=arm,
        spread=np.tile(p.area / 12 * np.eye(dim - 1), (len(i), 1, 1)),
        column=np.arange(len(i)),
        walls=walls,
    )


def columns_of_pillar(scene: Scene, p: Properties, contacts: Contacts, turns: bool) -> Columns:
    """Return the law of the contacts, each in a column of its own."""
    walls = [p.at_start if one == "start" else p.at_end for one in contacts.walls]
    normal = np.append(p.stiffness, [one.wall_stiffness for one in walls])
    shear = np.append(p.shear_stiffness, [one.wall_shear_stiffness for one in walls])
    eta, rock, rest = p.joint_time_constant, p.rock_compliance, np.zeros(len(walls))
    which = np.full(len(normal), 1 + len(scene.layers))  # of no joint
    which[: len(p.weld)][~p.weld], which[p.soft] = 0, 1 + np.arange(len(p.soft))
    rule = scene.joints.point_rule, scene.joints.contact_points
    return columns_of(
        scene,
        [scene.joints, *scene.layers, JointLaw()][: which.max() + 1],
        which,
        np.stack([normal, shear]),
        eta=None if eta is None else np.tile(np.append(eta, rest), (2, 1)),
        rock=None if rock is None else np.append(rock, rest),
        rules=[rule if turns else ("midpoint", 1)],
        shears=contacts.frame.shape[1] > 1,
    )
